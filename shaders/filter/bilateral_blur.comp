// One axis of a depth-aware Gaussian. A tap at distance d with depth z_d counts exp2(-d^2 / (2 sigma^2) - q^2), with
// q = (z_d - slope d - z_0) sharpness / z_0: relative to the depth, so that neither scale nor distance changes it.
layout(local_size_x = 64, local_size_y = 1) in;

layout(SIGNAL_FORMAT) uniform readonly image2D SOURCE;
layout(DEPTH_FORMAT) uniform readonly image2D view_depth;
layout(SIGNAL_FORMAT) uniform writeonly image2D TARGET;
uniform float sharpness;

// BAND pixels of the depth lie around the signal on each side.
float depthAt(ivec2 pixel, ivec2 last) {
    return imageLoad(view_depth, clamp(pixel, ivec2(-BAND), last + BAND) + BAND).r;
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = imageSize(TARGET);
    if (any(greaterThanEqual(pixel, size))) return;
    ivec2 last = size - 1;

    vec4 centre = imageLoad(SOURCE, pixel);
    float z0 = depthAt(pixel, last);
#ifdef SLOPE
    // The flatter of the two one-sided differences: the steeper one may span an edge. At the border there is but one.
    float ahead = depthAt(pixel + AXIS, last) - z0;
    float behind = z0 - depthAt(pixel - AXIS, last);
    if (any(greaterThan(pixel + AXIS, last + BAND))) ahead = behind;
    if (any(lessThan(pixel - AXIS, ivec2(-BAND)))) behind = ahead;
    float slope = abs(ahead) < abs(behind) ? ahead : behind;
#else
    float slope = 0.0;
#endif
    const float sigma = 0.5 * (float(RADIUS) + 1.0);
    float scale = z0 > 0.0 ? sharpness / z0 : 0.0;
    // The sum is of differences to the centre: a constant signal comes out to the bit.
    vec4 sum = vec4(0.0);
    float weights = 1.0;
    for (int d = -RADIUS; d <= RADIUS; ++d) {
        ivec2 at = pixel + d * AXIS;
        bool inside = all(greaterThanEqual(at, ivec2(0))) && all(lessThanEqual(at, last));
        float z = depthAt(at, last);
        float q = (z - slope * float(d) - z0) * scale;
        float weight = exp2(-float(d * d) / (2.0 * sigma * sigma) - min(q * q, 100.0));
        weight = inside && z > 0.0 && d != 0 ? weight : 0.0;
        sum += weight * (imageLoad(SOURCE, clamp(at, ivec2(0), last)) - centre);
        weights += weight;
    }
    imageStore(TARGET, pixel, z0 > 0.0 ? centre + sum / weights : centre);
}
