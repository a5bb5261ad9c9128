// Temporal accumulation (SVGF, Schied et al. 2017, section 4.1 and 4.2): the mean of up to `frames` frames, followed over
// motion, with the mean and the variance of its brightness. Everything is summed as differences to this frame's signal
// and to the old moments, so that a constant signal comes out to the bit and its variance is 0.
#include "filter/history.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(SIGNAL_FORMAT) uniform readonly image2D signal;
layout(HISTORY_FORMAT) uniform writeonly image2D MEAN;
// Mean and variance of the brightness, frames in them, sum of their weights.
WRITES_RECORDS(vec4, moments, Moments);
#ifdef PAST
layout(HISTORY_FORMAT) uniform readonly image2D PREVIOUS_HISTORY;
RECORDS(vec4, rgba32f, previous_moments, PreviousMoments);
#endif
WRITES_RECORDS(vec4, geometry, Geometry);
#ifdef WEIGHTED
uniform sampler2D weight;
#endif
#ifdef GRADIENT
uniform sampler2D change;
#endif
#ifdef HISTORY_LENGTH
layout(r32f) uniform writeonly image2D history_length;
#endif
uniform float frames; // the longest history
uniform int restart;  // 1: there is no last frame
uniform float clampDeviations;

#ifdef CLAMP
// The signal's mean and deviation in the 5 x 5 pixels around, as differences to `centre`.
void neighbourhood(ivec2 pixel, ivec2 last, vec4 centre, out vec4 mean, out vec4 deviation) {
    vec4 sum = vec4(0.0), squares = vec4(0.0);
    for (int y = -2; y <= 2; ++y)
        for (int x = -2; x <= 2; ++x) {
            vec4 d = imageLoad(signal, clamp(pixel + ivec2(x, y), ivec2(0), last)) - centre;
            sum += d;
            squares += d * d;
        }
    mean = sum / 25.0;
    deviation = sqrt(max(squares / 25.0 - mean * mean, vec4(0.0)));
}
#endif

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = imageSize(MEAN);
    if (any(greaterThanEqual(pixel, size))) return;

    vec4 now = imageLoad(signal, pixel);
    float light = brightness(now);
    vec4 surface = geometryAt(pixel);
    int record = recordIndex(pixel, size);
    geometry[record] = surface;

    vec4 difference = vec4(0.0); // history - now
    vec2 momentsBefore = vec2(light, 0.0);
    float count = 0.0, total = 0.0;
#ifdef PAST
    if (surface.w > 0.0 && restart == 0) {
        Past past = pastOf(pixel, surface);
        vec2 corner = floor(past.texel), part = past.texel - corner;
        vec4 sum = vec4(0.0), sums = vec4(0.0);
        float share = 0.0;
#ifdef MOTION
        // Far outside a motion vector may be larger than whole numbers are.
        ivec2 first = ivec2(clamp(corner, vec2(-2.0), vec2(size) + 1.0));
        for (int i = 0; i < 4; ++i) {
            ivec2 offset = ivec2(i & 1, i >> 1);
            vec2 side = mix(1.0 - part, part, vec2(offset));
#else
        ivec2 first = pixel;
        {
            const ivec2 offset = ivec2(0);
            const vec2 side = vec2(1.0);
#endif
            ivec2 texel = first + offset;
            ivec2 inside = clamp(texel, ivec2(0), size - 1);
            float w = sameSurface(past, texel, size) ? side.x * side.y : 0.0;
            sum += w * (imageLoad(PREVIOUS_HISTORY, inside) - now);
            sums += w * (RECORD(previous_moments, recordIndex(inside, size)) - vec4(light, 0.0, 0.0, 0.0));
            share += w;
        }
#ifdef SEARCH
        // With jitter a thin surface may have been seen by a neighbour only. Only leaving a loop saves work on a CPU
        // driver: where the surface was found it ends after the first iteration, which then counts nothing.
        bool found = share > 0.01;
        ivec2 nearest = ivec2(clamp(floor(past.texel + 0.5), vec2(-2.0), vec2(size) + 1.0));
        int end = found ? 1 : 9;
        for (int i = 0; i < end; ++i) {
            ivec2 texel = nearest + ivec2(i % 3, i / 3) - 1;
            ivec2 inside = clamp(texel, ivec2(0), size - 1);
            float w = !found && sameSurface(past, texel, size) ? 1.0 : 0.0;
            sum += w * (imageLoad(PREVIOUS_HISTORY, inside) - now);
            sums += w * (RECORD(previous_moments, recordIndex(inside, size)) - vec4(light, 0.0, 0.0, 0.0));
            share += w;
        }
#endif
        if (share > 0.01) {
            difference = sum / share;
            sums /= share;
            momentsBefore = vec2(light + sums.x, sums.y);
            count = sums.z;
            total = sums.w;
        }
    }
#endif
#ifdef GRADIENT
    // Where the signal changed, the history counts that much less.
    float keep = 1.0 - texture(change, (vec2(pixel) + 0.5) / (vec2(textureSize(change, 0)) * float(TILE))).r;
    count *= keep;
    total *= keep;
#endif
#ifdef CLAMP
    vec4 mean, deviation;
    neighbourhood(pixel, size - 1, now, mean, deviation);
    difference = clamp(difference, mean - clampDeviations * deviation, mean + clampDeviations * deviation);
#endif

    // As many frames as there may be: from then on the old ones fade, all weights alike.
    if (count + 1.0 > frames) total *= (frames - 1.0) / count;
#ifdef WEIGHTED
    float w = texelFetch(weight, pixel, 0).r;
#else
    const float w = 1.0;
#endif
    total += w;
    count = min(count + (w > 0.0 ? 1.0 : 0.0), frames);
    float fresh = total > 0.0 ? w / total : 1.0;
    bool nothing = surface.w == 0.0;
    imageStore(MEAN, pixel, nothing ? now : now + (1.0 - fresh) * difference);
    float step = light - momentsBefore.x;
    vec4 made = vec4(momentsBefore.x + fresh * step, (1.0 - fresh) * (momentsBefore.y + fresh * step * step), count, total);
    moments[record] = nothing ? vec4(light, 0.0, 0.0, 0.0) : made;
#ifdef HISTORY_LENGTH
    imageStore(history_length, pixel, vec4(nothing ? 0.0 : count));
#endif
}
