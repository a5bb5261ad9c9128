// One iteration of the variance-guided a-trous wavelet filter (SVGF, section 4.3 and 4.4): a B3 spline over taps `stride`
// pixels apart that stops at edges of depth, normal and brightness. Normals weigh by exp(sigma (cosine - 1)), which for
// the large exponents in use is the power of the paper without its logarithm. The signal's variance goes along.
#include "filter/signal.glsl"
#include "filter/records.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

RECORDS(FILTERED_TYPE, FILTERED_FORMAT, SOURCE, SOURCE_BLOCK);
#ifdef LAST
layout(HISTORY_FORMAT) uniform writeonly image2D result;
#else
WRITES_RECORDS(FILTERED_TYPE, target, TARGET_BLOCK);
#endif
#ifdef HISTORY
layout(HISTORY_FORMAT) uniform writeonly image2D HISTORY;
#endif
#ifdef ALPHA
layout(HISTORY_FORMAT) uniform readonly image2D MEAN; // its alpha: that of SOURCE holds the variance
#endif
RECORDS(vec4, rgba32f, geometry, Geometry);
layout(std140) uniform ResultView { ViewData resultView; };
uniform int stride; // pixels between taps
uniform float sigmaDepth;
uniform float sigmaNormal;
uniform float sigmaLuminance;

// Signal and variance: of one channel in two, else the variance is the fourth.
vec4 sourceAt(ivec2 pixel, ivec2 size) {
#ifdef ONE_CHANNEL
    vec2 record = RECORD(SOURCE, recordIndex(pixel, size)).xy;
    return vec4(record.x, 0.0, 0.0, record.y);
#else
    return RECORD(SOURCE, recordIndex(pixel, size));
#endif
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = ivec2(resultView.size);
    if (any(greaterThanEqual(pixel, size))) return;
    ivec2 last = size - 1;

    int record = recordIndex(pixel, size);
    vec4 centre = sourceAt(pixel, size);
    vec4 surface = RECORD(geometry, record);
    ImagePlane plane = imagePlane(resultView, mat3(resultView.view) * surface.xyz, vec2(pixel) + 0.5, surface.w,
                                  pictureScale(resultView, surface.w) * sigmaDepth);
    // One pixel's estimate is itself noise: a 3 x 3 Gaussian steadies it.
    float variance = 0.0;
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
            float w = 0.25 / float((1 + abs(x)) * (1 + abs(y)));
            variance += w * sourceAt(clamp(pixel + ivec2(x, y), ivec2(0), last), size).a;
        }
    float light = brightness(centre);
    // In the exponent of 2. Where nothing varies, what differs by more than rounding is another value.
    const float e = 1.44269504;
    float scale = e / (sigmaLuminance * sqrt(variance) + 1e-6 * abs(light) + 1e-30);

    // Sums of differences to the centre: a constant comes out to the bit.
    vec4 sum = vec4(0.0);
    float weights = 1.0, varianceSum = centre.a;
    for (int y = -RADIUS; y <= RADIUS; ++y)
        for (int x = -RADIUS; x <= RADIUS; ++x) {
            ivec2 at = pixel + ivec2(x, y) * stride;
            ivec2 inside = clamp(at, ivec2(0), last);
            vec4 other = RECORD(geometry, recordIndex(inside, size));
            vec4 value = sourceAt(inside, size);
            vec4 d = value - centre;
            float off = abs(planeDistance(plane, vec2(at) + 0.5, other.w)) + sigmaNormal * (1.0 - dot(other.xyz, surface.xyz));
            float power = off * e + abs(brightness(d)) * scale;
            // 1, 2/3, 1/6: the spline over its value at the centre.
            float kernel = (x == 0 ? 1.0 : abs(x) == 1 ? K1 : K2) * (y == 0 ? 1.0 : abs(y) == 1 ? K1 : K2);
            bool counts = at == inside && other.w > 0.0 && at != pixel;
            float w = counts ? kernel * exp2(-min(power, 120.0)) : 0.0;
            sum += w * d;
            weights += w;
            varianceSum += w * w * value.a;
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
    imageStore(result, pixel, vec4(made.rgb, alpha));
#elif defined(ONE_CHANNEL)
    target[record] = vec2(made.r, left);
#else
    target[record] = vec4(made.rgb, left);
#endif
}
