// Samples on a disc around a surface point, seen head-on, and what depths found there tell of its occlusion (Brüll, Kern,
// Grosch, "Stenciled Volumetric Ambient Occlusion", 2022). A program with KERNEL_VAO or KERNEL_HBAO contains that kernel
// only, others choose by the block.
//
// Lengths around the point are in radii. `height` is how far nearer to the eye than the point something is, along the line of
// sight; the chord of the sphere over a sample reaches from `front`, half a chord up, down to `back`, where the tangent plane
// cuts it. Contributions are visible volume (vao) or minus the occlusion (hbao): more occluders make them smaller, and what
// several depths tell together is the least of what each tells.
#include "ambient_occlusion/eye_grid.glsl"
#include "shared/ambient_occlusion.h"

layout(std140) uniform Settings { OcclusionKernel kernel; };

#if defined(KERNEL_VAO)
#define IS_HBAO false
#elif defined(KERNEL_HBAO)
#define IS_HBAO true
#else
#define IS_HBAO (kernel.kernel == kernelHbao)
#endif

struct DiscPoint {
    vec3 position;            // eye space
    vec3 tangent, bitangent;  // one radius long
    vec3 toEye;               // unit
    vec3 normal;              // eye space
    vec2 slope;               // of the tangent plane along tangent and bitangent: height over way
    float radius, perRadius;  // scene units, one over them
    float radiusPixels;       // of the image
    float cutoffSquared;      // of the kernel's, pixels of the image
    float away;               // distance from the eye, or from its plane of a parallel projection
    vec2 place;               // pixel coordinate in the image
    vec3 rise;                // of a surface per depth of it, radii: its height changes by xy a pixel, and is z at `place`
};

// Of the 4 x 4 ordered dither matrix, as turns.
#define TURN(k) vec2(sin(float(k) * 0.39269908), cos(float(k) * 0.39269908))
const vec2 discTurns[16] = vec2[](TURN(0), TURN(8), TURN(2), TURN(10), TURN(12), TURN(4), TURN(14), TURN(6), TURN(3), TURN(11),
                                  TURN(1), TURN(9), TURN(15), TURN(7), TURN(13), TURN(5));

// `pixel` counts from the corner of the frame, guard band excluded; `divisor` is the image's.
DiscPoint discPoint(EyeGrid grid, vec2 place, float depth, vec3 normal, ivec2 pixel, float divisor) {
    DiscPoint point;
    point.place = place;
    point.position = eyePosition(grid, place, depth);
    point.away = grid.parallel ? depth : length(point.position);
    point.toEye = grid.parallel ? vec3(0.0, 0.0, 1.0) : -point.position / point.away;
    point.normal = dot(normal, point.toEye) < 0.0 ? -normal : normal;

    float pixelsPerUnit = 0.5 * (grid.perUnit.x + grid.perUnit.y) / (grid.parallel ? 1.0 : depth);
    float most = kernel.maximumRadius / (divisor * pixelsPerUnit);
    point.radius = min(kernel.radius, most);
    point.perRadius = 1.0 / point.radius;
    point.radiusPixels = point.radius * pixelsPerUnit;
    point.rise = -point.perRadius * (grid.parallel ? vec3(0.0, 0.0, 1.0) : vec3(-point.toEye.xy * grid.unitsPer, point.away / depth));
    point.cutoffSquared = kernel.cutoff * kernel.cutoff / (divisor * divisor);

    vec2 turn = discTurns[(pixel.x & 3) + 4 * (pixel.y & 3)];
    vec3 bitangent = normalize(cross(point.toEye, vec3(turn, 0.0)));
    vec3 tangent = cross(bitangent, point.toEye);
    point.slope = -vec2(dot(point.normal, tangent), dot(point.normal, bitangent)) / max(dot(point.normal, point.toEye), 1e-4);
    point.tangent = tangent * point.radius;
    point.bitangent = bitangent * point.radius;
    return point;
}

struct DiscSample {
    vec3 position; // on the disc, eye space
    vec2 place;    // pixel coordinate in the image
    ivec2 pixel;   // the nearest one that the image has
    float front, back;
    float scale;   // one over the density
    float whole;   // contribution where nothing occludes
    bool counts;   // enough of its chord is before the tangent plane
    float outside; // how far outside of the image its place lies, pixels; negative inside
    bool self;     // the point's own pixel
};

DiscSample discSample(EyeGrid grid, DiscPoint point, ivec2 size, vec4 disc) {
    DiscSample s;
    s.front = disc.z;
    s.back = clamp(dot(disc.xy, point.slope), -disc.z, disc.z);
    s.scale = disc.w;
    s.whole = IS_HBAO ? 0.0 : (s.front - s.back) * s.scale;
    s.counts = s.front - s.back > 0.2 * disc.z;
    s.position = point.position + disc.x * point.tangent + disc.y * point.bitangent;
    // A disc about a point near the eye may reach behind it: such a sample lies outside of any image.
    float depth = grid.parallel ? 1.0 : max(-s.position.z, -1e-3 * point.position.z);
    s.place = grid.axis + grid.perUnit * s.position.xy / depth;
    s.pixel = ivec2(clamp(s.place, vec2(0.0), vec2(size) - 0.5));
    vec2 centre = 0.5 * vec2(size), beyond = abs(s.place - centre) - centre;
    s.outside = max(beyond.x, beyond.y);
    s.self = s.pixel == ivec2(point.place);
    return s;
}

float sampleHeight(DiscPoint point, vec3 position) { return dot(position - point.position, point.toEye) * point.perRadius; }

// The same of a depth at a pixel coordinate, in few operations.
float heightAt(DiscPoint point, vec2 place, float depth) {
    return depth * (dot(place - point.place, point.rise.xy) + point.rise.z) + point.away * point.perRadius;
}

float vaoContribution(DiscSample s, float height) {
    // Below the tangent plane the chord is free, inside the sphere what lies before; beyond the sphere's front and the
    // thickness it comes back, so that what is far in front casts no halo.
    float ramp = clamp((height - 1.0 - kernel.thickness) * 2.0 * s.scale, 0.0, 1.0); // the density is the chord, twice the front
    return max(s.front - max(s.back, height), 0.0) * s.scale + ramp * s.whole;
}

float hbaoContribution(DiscPoint point, DiscSample s, vec3 position) {
    vec3 way = position - point.position;
    float squared = dot(way, way);
    float angle = clamp(dot(point.normal, way) * inversesqrt(max(squared, 1e-30)) - 0.1, 0.0, 1.0);
    float falloff = clamp(1.0 - squared * point.perRadius * point.perRadius, 0.0, 1.0);
    return -clamp(angle * falloff * s.scale, 0.0, 1.0);
}

// Of something at an eye-space position.
float contribution(DiscPoint point, DiscSample s, vec3 position) {
    return IS_HBAO ? hbaoContribution(point, s, position) : vaoContribution(s, sampleHeight(point, position));
}

// Of a depth at a pixel coordinate, whose height is known.
float contributionAt(EyeGrid grid, DiscPoint point, DiscSample s, vec2 place, float depth, float height) {
    return IS_HBAO ? hbaoContribution(point, s, eyePosition(grid, place, depth)) : vaoContribution(s, height);
}

// How high the range ends in which depths behind the first may occlude.
float reachOf(DiscSample s) { return IS_HBAO ? max(s.front, 0.1) : 1.0 + kernel.thickness + s.front; }

// Whether a first surface so high may hide what occludes.
bool mayHide(DiscPoint point, DiscSample s, float height) {
    float least = IS_HBAO ? max(s.front, 0.1) : 1.0 + kernel.thickness;
    vec2 way = s.place - point.place;
    return height > least && dot(way, way) > point.cutoffSquared;
}

// Of the sum of contributions, before it is clamped and raised to the exponent.
float meanVisibility(float sum, uint samples) { return (IS_HBAO ? 1.0 : 0.0) + 2.0 * sum / float(samples); }

float finalVisibility(float mean) { return pow(clamp(mean, 0.0, 1.0), kernel.exponent); }
