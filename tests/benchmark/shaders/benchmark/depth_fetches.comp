// What AmbientOcclusionFirst cannot do without: the depth at each of its samples, found and added up.
#include "ambient_occlusion/disc_images.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(r16f) uniform writeonly image2D sum;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(sum)))) return;
    EyeGrid grid = eyeGrid(depthView);
    float depth;
    DiscPoint point = pointAt(grid, pixel, depth);
    float total = 0.0;
    for (int i = 0; i < SAMPLES; ++i)
        total += imageLoad(view_depth, discSample(grid, point, ivec2(depthView.size), kernel.disc[i]).pixel).r;
    imageStore(sum, pixel, vec4(total));
}
