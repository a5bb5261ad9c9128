// Visibility of lights through shadow maps: depths (reversed) in an array.
//
// `taps` texels along each axis are compared, 1, 2 or 4. 1 takes the nearest; 2 weights by distance; 4 is a box of three
// texels with weighted borders (percentage-closer filtering: Reeves, Salesin and Cook, "Rendering Antialiased Shadows with
// Depth Maps", 1987).
//
// Acne. A texel holds the depth at its middle, so a surface is compared with itself at up to e texels from there. In 1 / z
// a plane is linear over the face, and raising the receiver by |n_xy| e along its normal n, with n_xy the part of n in the
// face's plane, is exactly what keeps a plane from shadowing itself, at any tilt. What is left is rounding.
#include "lib/light_maps.glsl"

const float shadowRounding = 2e-6; // of a depth of perspective maps, of the width of parallel ones
const float shadowReach = 1.5e-7;  // of the way that parallel rays come: what float leaves of a triangle as long as that

// Whether something stands before the depth.
float shadowTap(sampler2DArray shadowMaps, ivec2 texel, int layer, int last, float depth) {
    return texelFetch(shadowMaps, ivec3(clamp(texel, ivec2(0), ivec2(last)), layer), 0).r > depth ? 1.0 : 0.0;
}

// Share of the light that reaches the position with unit normal n, on the light's side; a bias of 1 is as derived. Outside of
// the map everything is lit.
float shadowVisibility(sampler2DArray shadowMaps, LightMap map, vec3 position, vec3 n, float bias, const int taps) {
    int size = textureSize(shadowMaps, 0).x;
    float resolution = float(size);
    LightMapPlace place = lightMapPlace(map, position, resolution);
    uint face = uint(place.layer) - map.firstLayer;
    vec2 slope = lightMapTurned(lightMapLocal(map.axisX, map.axisY, map.axisZ, n), face).xy;
    float reach = taps == 1 ? 0.71 : taps == 2 ? 1.42 : 2.83;
    place = lightMapPlace(map, position + n * (bias * reach * place.footprint * length(slope)), resolution);
    float depth = place.depth + (map.faces == 0u ? max(shadowReach, 2.0 * shadowRounding * map.halfWidth * map.inverseRange)
                                                 : shadowRounding * place.depth);
    // Summed is what is blocked: the weights' rounding does not darken what is lit.
    float blocked = 0.0;
    if (taps == 1) {
        blocked = shadowTap(shadowMaps, ivec2(floor(place.texel)), place.layer, size - 1, depth);
    } else {
        ivec2 first = ivec2(floor(place.texel - 0.5)) - (taps / 2 - 1);
        vec2 f = fract(place.texel - 0.5);
        for (int y = 0; y < taps; ++y) {
            ITERATION;
            float wy = y == 0 ? 1.0 - f.y : y == taps - 1 ? f.y : 1.0;
            for (int x = 0; x < taps; ++x) {
                ITERATION;
                float wx = x == 0 ? 1.0 - f.x : x == taps - 1 ? f.x : 1.0;
                blocked += wx * wy * shadowTap(shadowMaps, first + ivec2(x, y), place.layer, size - 1, depth);
            }
        }
        blocked /= float((taps - 1) * (taps - 1));
    }
    return place.inside ? 1.0 - blocked : 1.0;
}
