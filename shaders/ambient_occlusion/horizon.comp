// Ambient occlusion slice by slice: planes through the line of sight, in which the depth is followed to both sides. Angles
// count from the direction to the eye. In each slice light is weighted by its solid angle and cosine, as in the whole
// hemisphere (Jimenez, Wu, Pesce, Jarabo, "Practical Real-Time Strategies for Accurate Indirect Occlusion", 2016, section 3).
//
// GTAO keeps the highest horizon of each side. BITMASK keeps 32 sectors of equal weight, and takes those away that lie between
// the front of a sample and its back, `thickness` behind (Therrien, Levesque, Gilet, "Screen Space Indirect Lighting with
// Visibility Bitmask", 2023): light passes behind what is thin. With LAYERS no thickness is assumed. Behind the first surface
// stand those that the layers tell of. All of them are surfaces, and reach back by LAYERS times the geometric mean of the
// sample's distance and the radius: about as far as what lies between two samples that neither of them meets.
#include "ambient_occlusion/eye_grid.glsl"
#ifdef LAYERS
#include "lib/frame.glsl"
#include "lib/layers.glsl"
#include <port:layers>
#endif

layout(local_size_x = 8, local_size_y = 8) in;

layout(r32f) uniform readonly image2D view_depth;
layout(rgba16f) uniform readonly image2D normal;
layout(r16f) uniform writeonly image2D visibility;
layout(std140) uniform ViewDepthView { ViewData depthView; };
uniform float radius;        // scene units
uniform float maximumRadius; // pixels of the frame
uniform float thickness;     // scene units
uniform float exponent;

// A slice's light. Sectors are parts of it of equal weight, counted from its lowest angle on.
struct Slice {
    float cosTurn, sinTurn; // of the angle from the direction to the eye to the normal, positive to the slice's own side
    float whole;            // weight of all
    float first, even, odd; // sectors below an angle, and a half: first + side * even * sin^2 + odd * angleLess()
};

// An angle less its cosine times its sine, by its cosine; to 1e-3, a sixtieth of a sector, without transcendental functions.
float angleLess(float c) {
    float c2 = c * c;
    return 1.5707963 + c * (((0.180664 * c2 - 0.160176) * c2 + 0.41592) * c2 - 2.008261);
}

// The weight of the light between the direction to the eye and an angle to one side (1 or -1), given by its cosine.
float weightTo(Slice slice, float cosine, float side) {
    return 0.5 * (slice.cosTurn * (1.0 - cosine * cosine) + side * slice.sinTurn * angleLess(cosine));
}

// Of the normal in the slice: along the direction to the eye, and to the slice's own side; unit.
Slice sliceOf(vec2 normal) {
    Slice slice = Slice(normal.x, normal.y, 1.0, 0.0, 0.0, 0.0);
    float low = weightTo(slice, slice.sinTurn, -1.0);
    slice.whole = low + weightTo(slice, -slice.sinTurn, 1.0);
    float sectors = 32.0 / slice.whole;
    slice.first = sectors * low + 0.5;
    slice.even = 0.5 * sectors * slice.cosTurn;
    slice.odd = 0.5 * sectors * slice.sinTurn;
    return slice;
}

// The square of how far a point lies beside the line of sight.
float besideSquared(vec3 offset, vec3 toEye) {
    float height = dot(offset, toEye);
    return max(dot(offset, offset) - height * height, 0.0);
}

// How high toward the eye a point stands when it is turned about the line of sight into the slice, as high over the surface
// as it is. Centres of pixels and texels lie beside the slice: as they are, they would raise a tilted plane over itself.
// `over` is the height over the surface, `lean` the normal's part to the slice's own side, `upright` one over its part toward
// the eye.
float heightInSlice(float over, float beside, float side, float lean, float upright) {
    return (over - side * sqrt(beside) * lean) * upright;
}

// The cosine of the angle to what lies `height` toward the eye and at the root of `beside` to the side.
float cosineOf(float height, float beside) { return height * inversesqrt(max(height * height + beside, 1e-30)); }

// The sectors below an angle.
uint sectorsBelow(Slice slice, float cosine, float side) {
    float c = max(cosine, -side * slice.sinTurn); // no lower than the surface
    uint count = uint(slice.first + side * slice.even * (1.0 - c * c) + slice.odd * angleLess(c));
    return count >= 32u ? 0xffffffffu : (1u << count) - 1u;
}

// Those between a height and one less by `extent`.
uint sectorsBehind(Slice slice, float side, float height, float beside, float extent) {
    return sectorsBelow(slice, cosineOf(height, beside), side) ^ sectorsBelow(slice, cosineOf(height - extent, beside), side);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(visibility)))) return;
    ivec2 at = pixel + int(depthView.guard);
    ivec2 size = ivec2(depthView.size);
    EyeGrid grid = eyeGrid(depthView);
    float depth = imageLoad(view_depth, at).r;
    vec2 centre = vec2(at) + 0.5;
    float own = depthOrFar(depth);
    vec3 position = eyePosition(grid, centre, own);
    vec3 toEye = grid.parallel ? vec3(0.0, 0.0, 1.0) : -normalize(position);
    vec3 n = mat3(depthView.view) * imageLoad(normal, at).xyz;
    n = dot(n, toEye) < 0.0 ? -n : n;
    float perUnit = 0.5 * (grid.perUnit.x + grid.perUnit.y) / (grid.parallel ? 1.0 : own);
    float reach = min(radius * perUnit, maximumRadius / float(depthView.divisor));
    float far = reach / perUnit;

    // Of 4 x 4 pixels each has its own slices, and of each diagonal its own steps.
    float turned = (float(bitfieldReverse(uint((pixel.x ^ pixel.y) & 3)) >> 30) * 4.0 +
                    float(bitfieldReverse(uint(pixel.y & 3)) >> 30) + 0.5) / 16.0;
    float shift = (float((pixel.y - pixel.x) & 3) + 0.5) / 4.0;
#ifdef LAYERS
    vec2 toFrame = float(depthView.divisor) / vec2(frame.size), fromFrame = vec2(frame.size) / float(depthView.divisor);
    float band = float(depthView.guard);
#endif
    float upright = 1.0 / max(dot(n, toEye), 0.1);

    float open = 0.0, light = 0.0;
    for (int i = 0; i < SLICES; ++i) {
        float phi = 3.1415927 * (float(i) + turned) / float(SLICES);
        vec2 way = vec2(cos(phi), sin(phi));
        vec3 along = vec3(way, 0.0);
        along = normalize(along - dot(along, toEye) * toEye);
        vec2 inSlice = vec2(dot(n, toEye), dot(n, along));
        float weight = max(length(inSlice), 1e-4);
        Slice slice = sliceOf(inSlice / weight);
        vec2 lowest = vec2(slice.sinTurn, -slice.sinTurn); // cosines, of the sides -1 and 1
        vec2 horizon = lowest;
        uint hidden = 0u;
        for (int k = 0; k < 2 * STEPS; ++k) {
            float side = k < STEPS ? -1.0 : 1.0;
            float t = (float(k < STEPS ? k : k - STEPS) + shift) / float(STEPS);
            vec2 place = centre + side * max(reach * t * t, 1.0) * way;
            ivec2 there = ivec2(floor(place));
            bool inside = all(greaterThanEqual(there, ivec2(0))) && all(lessThan(there, size));
            float z = inside ? imageLoad(view_depth, clamp(there, ivec2(0), size - 1)).r : 0.0;
            vec3 offset = eyePosition(grid, vec2(there) + 0.5, depthOrFar(z)) - position;
            float squared = dot(offset, offset), beside = besideSquared(offset, toEye);
            float height = heightInSlice(dot(offset, n), beside, side, inSlice.y, upright);
            bool counts = z > 0.0 && squared < far * far && squared > 0.0;
#ifdef BITMASK
#ifdef LAYERS
            float extent = LAYERS * far * t;
#else
            float extent = thickness;
#endif
            uint taken = sectorsBehind(slice, side, height, beside, extent);
            if (counts) hidden |= taken;
#ifdef LAYERS
            // Where the ray of the texel's samples passes through the sphere, as view depths less the own one.
            ivec2 texel = layers_texel((vec2(there) + 0.5 - band) * toFrame);
            vec2 column = layers_position(texel) * fromFrame + band;
            vec3 ray = grid.parallel ? vec3(0.0, 0.0, -1.0) : eyePosition(grid, column, 1.0);
            vec3 start = vec3((column - centre) * grid.unitsPer * (grid.parallel ? 1.0 : own), 0.0);
            float perSquare = 1.0 / dot(ray, ray), middle = -dot(start, ray) * perSquare;
            float half_ = sqrt(max(middle * middle - (dot(start, start) - far * far) * perSquare, 0.0));
            // The two nearest to the eye that lie within.
            float one = noLayer, two = noLayer;
            for (int layer = 0; layer < layers_count; ++layer) {
                float by = layers_depth(texel, layer) - own;
                by = abs(by - middle) < half_ ? by : noLayer;
                two = min(two, max(one, by));
                one = min(one, by);
            }
            for (int which = 0; which < 2; ++which) {
                float by = which == 0 ? one : two;
                vec3 found = start + (by < noLayer ? by : 0.0) * ray;
                float aside = besideSquared(found, toEye);
                float up = heightInSlice(dot(found, n), aside, side, inSlice.y, upright);
                uint more = sectorsBehind(slice, side, up, aside, extent);
                if (by < noLayer) hidden |= more;
            }
#endif
#else
            // Toward the radius a sample's horizon goes down to that of the hemisphere.
            float told = mix(cosineOf(height, beside), side > 0.0 ? lowest.y : lowest.x, clamp(squared / (far * far), 0.0, 1.0));
            if (counts && side > 0.0) horizon.y = max(horizon.y, told);
            if (counts && side < 0.0) horizon.x = max(horizon.x, told);
#endif
        }
#ifdef BITMASK
        open += weight * slice.whole * (1.0 - float(bitCount(hidden)) / 32.0);
#else
        open += weight * (weightTo(slice, horizon.x, -1.0) + weightTo(slice, horizon.y, 1.0));
#endif
        light += weight * slice.whole;
    }
    // Of the light of these slices: a few have more or less than their share of the hemisphere's.
    bool nothing = depth == 0.0 || reach < 1.0;
    float share = nothing ? 1.0 : clamp(open / light, 0.0, 1.0);
    imageStore(visibility, pixel, vec4(pow(share, exponent)));
}
