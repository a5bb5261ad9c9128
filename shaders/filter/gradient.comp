// Where the signal changed though the surface did not, a tile of TILE x TILE pixels at a time: 0 not, 1 wholly.
//
// A-SVGF (Schied et al. 2018, section 4) shades single pixels of the last frame again with the last frame's random
// numbers; the difference is free of noise. A filter that is handed a signal cannot do that. What it can do is a test:
// the mean over the tile of (signal - history) of the same surfaces against its standard error. The error is the larger
// of what the spread within the tile says and of what this mean has been in the frames before, since noise may be alike
// over a whole tile. Changes below three such errors are not seen and decay as the history does; above six the history
// is dropped.
#include "filter/history.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(SIGNAL_FORMAT) uniform readonly image2D signal;
layout(HISTORY_FORMAT) uniform readonly image2D PREVIOUS_HISTORY;
// The change, and the mean square of the tile's mean difference.
layout(rg32f) uniform readonly image2D previous_change;
layout(rg32f) uniform writeonly image2D change;
uniform int restart;

void main() {
    ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(tile, imageSize(change)))) return;
    ivec2 size = imageSize(signal);

    float count = 0.0, sum = 0.0, squares = 0.0, brightest = 0.0;
    for (int i = 0; i < TILE * TILE; ++i) {
        ivec2 pixel = tile * TILE + ivec2(i % TILE, i / TILE);
        ivec2 inside = min(pixel, size - 1);
        vec4 surface = geometryAt(inside);
        Past past = pastOf(inside, surface);
        ivec2 texel = ivec2(floor(clamp(past.texel, vec2(-2.0), vec2(size) + 1.0) + 0.5));
        float now = brightness(imageLoad(signal, inside));
        float before = brightness(imageLoad(PREVIOUS_HISTORY, clamp(texel, ivec2(0), size - 1)));
        bool counts = pixel == inside && surface.w > 0.0 && sameSurface(past, texel, size);
        float d = counts ? now - before : 0.0;
        count += counts ? 1.0 : 0.0;
        sum += d;
        squares += d * d;
        brightest = counts ? max(brightest, max(abs(now), abs(before))) : brightest;
    }
    vec2 made = vec2(0.0);
    if (count >= 4.0 && restart == 0) {
        float mean = sum / count;
        float spread = max(squares / count - mean * mean, 0.0) / (count - 1.0);
        float usual = imageLoad(previous_change, tile).g;
        float noise = sqrt(max(spread, usual));
        // Rounding is no change.
        float excess = abs(mean) - 1e-5 * brightest;
        made.r = excess <= 3.0 * noise ? 0.0 : noise > 0.0 ? min((excess - 3.0 * noise) / (3.0 * noise), 1.0) : 1.0;
        // One change must not hide the next: it counts as three errors at most.
        made.g = usual + 0.1 * (min(mean * mean, 9.0 * max(usual, spread)) - usual);
    }
    imageStore(change, tile, vec4(made, 0.0, 0.0));
}
