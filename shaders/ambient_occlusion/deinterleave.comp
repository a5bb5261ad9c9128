// Every fourth pixel of every fourth row into a layer of its own: pixel (x, y) lies in layer x mod 4 + 4 (y mod 4) at
// (x / 4, y / 4). What layers have beyond the image is empty.
layout(local_size_x = 8, local_size_y = 8) in;

layout(r32f) uniform readonly image2D view_depth;
layout(r32f) uniform writeonly image2DArray layers;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec3 target = ivec3(pixel >> 2, (pixel.x & 3) + 4 * (pixel.y & 3));
    if (any(greaterThanEqual(target, imageSize(layers)))) return;
    bool inside = all(lessThan(pixel, imageSize(view_depth)));
    imageStore(layers, target, vec4(inside ? imageLoad(view_depth, pixel).r : 0.0));
}
