// The first pass: occlusion by the first surface alone, and which samples something behind it may change.
#include "ambient_occlusion/disc_images.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(r16f) uniform writeonly image2D visibility;
#ifdef MEAN
layout(r16f) uniform writeonly image2D mean;
#endif
#ifdef MASK
layout(MASK_FORMAT) uniform writeonly uimage2D mask;
uniform float reach; // of the stochastic depth map: how far it goes beyond the depth, pixels of the depth
#endif

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(visibility)))) return;
    EyeGrid grid = eyeGrid(depthView);
    float depth;
    DiscPoint point = pointAt(grid, pixel, depth);

    // Nothing, or a sphere that is smaller than a pixel, is open.
    bool open = depth == 0.0 || point.radiusPixels < 0.5;
#ifdef MASK
    int count = open ? 0 : SAMPLES;
#else
    const int count = SAMPLES; // unrolled, which gains more than leaving out what is open
#endif
    float sum = 0.0;
    uint bits = 0u;
    for (int i = 0; i < count; ++i) {
        DiscSample s = discSample(grid, point, ivec2(depthView.size), kernel.disc[i]);
        float height;
        bool hidden;
        float value = firstContribution(grid, point, s, height, hidden);
        if (s.counts) sum += value;
#ifdef MASK
        if (s.counts && !s.self && (s.outside < 0.0 ? hidden : s.outside < reach)) bits |= 1u << i;
#endif
    }
    float share = open ? 1.0 : meanVisibility(sum, uint(SAMPLES));
    imageStore(visibility, pixel, vec4(finalVisibility(share)));
#ifdef MEAN
    imageStore(mean, pixel, vec4(share));
#endif
#ifdef MASK
    imageStore(mask, pixel, uvec4(bits));
#endif
}
