// One iteration of the variance-guided a-trous wavelet filter (SVGF, section 4.3 and 4.4): a B3 spline over taps `stride`
// pixels apart that stops at edges of depth, normal and brightness. Normals weigh by exp(sigma (cosine - 1)), which for
// the large exponents in use is the power of the paper without its logarithm. The signal's variance goes along.
#include "filter/signal.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(FILTERED_FORMAT) uniform readonly image2D SOURCE;
layout(TARGET_FORMAT) uniform writeonly image2D TARGET;
#ifdef HISTORY
layout(HISTORY_FORMAT) uniform writeonly image2D HISTORY;
#endif
#ifdef ALPHA
layout(HISTORY_FORMAT) uniform readonly image2D MEAN; // its alpha: that of SOURCE holds the variance
#endif
layout(rgba32f) uniform readonly image2D geometry;
layout(std140) uniform GeometryView { ViewData geometryView; };
uniform int stride; // pixels between taps
uniform float sigmaDepth;
uniform float sigmaNormal;
uniform float sigmaLuminance;

#ifdef ONE_CHANNEL
float varianceOf(vec4 value) { return value.g; }
#else
float varianceOf(vec4 value) { return value.a; }
#endif

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = imageSize(TARGET);
    if (any(greaterThanEqual(pixel, size))) return;
    ivec2 last = size - 1;

    vec4 centre = imageLoad(SOURCE, pixel);
    vec4 surface = imageLoad(geometry, pixel);
    ImagePlane plane = imagePlane(geometryView, mat3(geometryView.view) * surface.xyz, vec2(pixel) + 0.5, surface.w,
                                  pictureScale(geometryView, surface.w) * sigmaDepth);
    // One pixel's estimate is itself noise: a 3 x 3 Gaussian steadies it.
    float variance = 0.0;
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
            float w = 0.25 / float((1 + abs(x)) * (1 + abs(y)));
            variance += w * varianceOf(imageLoad(SOURCE, clamp(pixel + ivec2(x, y), ivec2(0), last)));
        }
    float light = brightness(centre);
    // In the exponent of 2. Where nothing varies, what differs by more than rounding is another value.
    const float e = 1.44269504;
    float scale = e / (sigmaLuminance * sqrt(variance) + 1e-6 * abs(light) + 1e-30);

    // Sums of differences to the centre: a constant comes out to the bit.
    vec4 sum = vec4(0.0);
    float weights = 1.0, varianceSum = varianceOf(centre);
    for (int y = -RADIUS; y <= RADIUS; ++y)
        for (int x = -RADIUS; x <= RADIUS; ++x) {
            ivec2 at = pixel + ivec2(x, y) * stride;
            ivec2 inside = clamp(at, ivec2(0), last);
            vec4 other = imageLoad(geometry, inside);
            vec4 value = imageLoad(SOURCE, inside);
            vec4 d = value - centre;
            float off = abs(planeDistance(plane, vec2(at) + 0.5, other.w)) + sigmaNormal * (1.0 - dot(other.xyz, surface.xyz));
            float power = off * e + abs(brightness(d)) * scale;
            // 1, 2/3, 1/6: the spline over its value at the centre.
            float kernel = (x == 0 ? 1.0 : abs(x) == 1 ? K1 : K2) * (y == 0 ? 1.0 : abs(y) == 1 ? K1 : K2);
            bool counts = at == inside && other.w > 0.0 && at != pixel;
            float w = counts ? kernel * exp2(-min(power, 120.0)) : 0.0;
            sum += w * d;
            weights += w;
            varianceSum += w * w * varianceOf(value);
        }
    bool nothing = surface.w == 0.0;
    vec4 made = nothing ? centre : centre + sum / weights;
    float left = nothing ? 0.0 : varianceSum / (weights * weights);
#ifdef ALPHA
    float alpha = imageLoad(MEAN, pixel).a;
#else
    const float alpha = 1.0;
#endif
#ifdef HISTORY
    imageStore(HISTORY, pixel, vec4(made.rgb, alpha));
#endif
#ifdef LAST
    imageStore(TARGET, pixel, vec4(made.rgb, alpha));
#elif defined(ONE_CHANNEL)
    imageStore(TARGET, pixel, vec4(made.r, left, 0.0, 0.0));
#else
    imageStore(TARGET, pixel, vec4(made.rgb, left));
#endif
}
