// The scene's lights at the frame's time, and what they send to a point, visibility left out. Everything is linear and in
// render space. Units: candela (point, spot) and lux (directional) as KHR_lights_punctual has them, radiance of the
// surface for the area kinds; irradiance comes out in the unit that radiance times steradian has.
#include "shared/ray.h"
#include "shared/scene.h"

layout(std430) readonly buffer Lights {
    uint scene_light_count;
    LightRecord scene_lights[];
};

// No light arrives stronger than this: a point on a light would give infinity, and sums of lights must stay finite.
const float lightMaximum = 1e30;

// ---- Point, spot, directional

// Share of the intensity that a cone of these cosines sends along unit `direction` (KHR_lights_punctual, "Inner and Outer
// Cone Angles").
float spotAttenuation(LightRecord light, vec3 direction) {
    float scale = 1.0 / max(0.001, light.cosInnerCone - light.cosOuterCone);
    float share = clamp((dot(light.direction, direction) - light.cosOuterCone) * scale, 0.0, 1.0);
    return share * share;
}

// The window that ends the light at its range (KHR_lights_punctual, "Range Property"); 1 without a range.
float rangeWindow(LightRecord light, float distanceToLight) {
    float share = light.range > 0.0 ? distanceToLight / light.range : 0.0;
    share *= share;
    return clamp(1.0 - share * share, 0.0, 1.0);
}

// Irradiance at `position` on a surface that faces the light. `toLight` is unit; `distanceToLight` is infinite for a
// directional light. A point in the light itself is lit from above and as strongly as can be.
vec3 punctualLight(LightRecord light, vec3 position, out vec3 toLight, out float distanceToLight) {
    vec3 offset = light.position - position;
    // By way of the largest component, or the squares of small and large scenes would leave the range of float.
    vec3 size = abs(offset);
    float largest = max(size.x, max(size.y, size.z));
    offset = largest > 0.0 ? offset / largest : vec3(0.0);
    float l = length(offset);
    distanceToLight = largest * l;
    toLight = l > 0.0 ? offset / l : -light.direction;
    vec3 arriving = light.intensity * rangeWindow(light, distanceToLight);
    if (light.kind == lightKindSpot) arriving *= spotAttenuation(light, -toLight);
    float inverse = 1.0 / max(distanceToLight, 1e-19);
    arriving = min(arriving * inverse, vec3(lightMaximum)) * inverse;
    if (light.kind == lightKindDirectional) {
        toLight = -light.direction;
        distanceToLight = uintBitsToFloat(0x7f800000u);
        arriving = light.intensity;
    }
    return min(arriving, vec3(lightMaximum));
}

// ---- Rectangle and sphere

// Radiance that leaves point `onLight` of an area light in unit `direction`: a rectangle shines to its front only, a
// sphere outwards.
vec3 areaLightRadiance(LightRecord light, vec3 onLight, vec3 direction) {
    vec3 outward = light.kind == lightKindRectangle ? light.direction : onLight - light.position;
    return dot(outward, direction) > 0.0 ? light.intensity : vec3(0.0);
}

// One edge's term of Lambert's formula from a to b (of any length), along unit n: the angle between them times the cosine
// between n and the normal of the plane that they span.
float edgeIntegral(vec3 a, vec3 b, vec3 n) {
    a *= inversesqrt(max(dot(a, a), 1e-30));
    b *= inversesqrt(max(dot(b, b), 1e-30));
    vec3 across = cross(a, b);
    float sine = length(across);
    float angle = atan(sine, dot(a, b));
    return sine > 0.0 ? angle / sine * dot(across, n) : 0.0;
}

// The term of the part above the plane of unit normal h, along n, and where the edge goes through the plane, if it does.
float clippedEdgeIntegral(vec3 a, vec3 b, vec3 n, vec3 h, inout vec3 leaving, inout vec3 entering) {
    float ha = dot(a, h);
    float hb = dot(b, h);
    bool crosses = (ha > 0.0) != (hb > 0.0);
    vec3 crossing = mix(a, b, crosses ? clamp(ha / (ha - hb), 0.0, 1.0) : 0.0);
    if (crosses && ha > 0.0) leaving = crossing;
    if (crosses && hb > 0.0) entering = crossing;
    vec3 from = ha > 0.0 ? a : crossing;
    vec3 to = hb > 0.0 ? b : crossing;
    bool above = ha > 0.0 || hb > 0.0;
    return above ? edgeIntegral(from, to, n) : 0.0;
}

// Irradiance at `position` with unit normal n, on a face of unit normal `face`, from a whole rectangle: Lambert's formula
// for a polygon, clipped at the horizon (Baum et al., "Improving Radiosity Solutions Through the Use of Analytically
// Determined Form-Factors", 1989). Nothing arrives from below the face, nor from below the horizon of n: the part above the
// face is what is seen along n if the face's plane cuts the rectangle, else the part above the horizon of n. Where both cut
// it, what lies between the two horizons is taken off, not left out.
vec3 rectangleLight(LightRecord light, vec3 position, vec3 n, vec3 face) {
    vec3 centre = light.position - position;
    float ahead = -dot(centre, light.direction);
    // In units of the distance, so that no scale leaves the range of float.
    float size = max(max(abs(centre.x), max(abs(centre.y), abs(centre.z))), max(light.halfSize.x, light.halfSize.y));
    if (!(ahead > 0.0) || !(light.halfSize.x > 0.0) || !(light.halfSize.y > 0.0)) return vec3(0.0);
    centre /= size;
    vec3 x = light.tangent * (light.halfSize.x / size);
    vec3 y = light.bitangent * (light.halfSize.y / size);
    float d2 = dot(centre, centre);
    float r2 = dot(x, x) + dot(y, y);
    float factor;
    if (r2 < 1e-3 * d2) {
        // Far away the formula cancels, and the rectangle is as good as its middle (error about r2 / d2).
        float area = 4.0 * length(x) * length(y);
        factor = leavesFace(centre * inversesqrt(d2), face) ? dot(centre, n) * (ahead / size) * area / (d2 * d2) : 0.0;
    } else {
        vec3 a = centre - x - y;
        vec3 b = centre + x - y;
        vec3 c = centre + x + y;
        vec3 d = centre - x + y;
        vec3 h = dot(centre, face) - abs(dot(x, face)) - abs(dot(y, face)) >= 0.0 ? n : face;
        vec3 leaving = h, entering = h;
        float sum = clippedEdgeIntegral(a, b, n, h, leaving, entering) + clippedEdgeIntegral(b, c, n, h, leaving, entering) +
                    clippedEdgeIntegral(c, d, n, h, leaving, entering) + clippedEdgeIntegral(d, a, n, h, leaving, entering);
        // What the horizon cuts off is replaced by an edge along it.
        sum += edgeIntegral(leaving, entering, n);
        // The corners go around counterclockwise about the way to the light, unless its axes are mirrored.
        factor = dot(cross(x, y), light.direction) > 0.0 ? -0.5 * sum : 0.5 * sum;
    }
    return min(light.intensity * max(factor, 0.0), vec3(lightMaximum));
}

// The same from a whole sphere, also where it stands partly below the horizon (Snyder, "Area Light Sources for Real-Time
// Graphics", 1996): half the integral around the part above, which consists of an arc of the sphere's outline and one of the
// horizon. Nothing arrives inside of it.
vec3 sphereLight(LightRecord light, vec3 position, vec3 n, vec3 face) {
    const float quarter = 1.57079632679490; // pi / 2
    vec3 centre = light.position - position;
    vec3 extent = abs(centre);
    float largest = max(extent.x, max(extent.y, extent.z));
    if (!(largest > 0.0)) return vec3(0.0);
    vec3 toCentre = centre / largest;
    float d = length(toCentre);
    toCentre /= d;
    float sine = light.halfSize.x / largest / d; // of half the angle that the sphere fills
    if (sine >= 1.0) return vec3(0.0);
    vec3 h = dot(toCentre, face) >= sine ? n : face; // as for a rectangle
    float c = clamp(dot(toCentre, h), -1.0, 1.0);
    float factor;
    if (c >= sine) {
        factor = 2.0 * quarter * sine * sine * dot(toCentre, n);
    } else if (c <= -sine) {
        factor = 0.0;
    } else {
        float s = sqrt(1.0 - c * c);
        float cotangent = sqrt(1.0 - sine * sine) / sine;
        float y = clamp(-cotangent * c / s, -1.0, 1.0);
        float root = s * sqrt(1.0 - y * y);
        float beyond = atan(root, cotangent); // half the arc of the horizon
        // Along h, and the cosine of what is perpendicular to it.
        float across = (dot(toCentre, n) - c * dot(h, n)) / s;
        factor = dot(h, n) * ((c * acos(y) - cotangent * root) * sine * sine + beyond) +
                 across * (s * acos(y) + cotangent * c * sqrt(1.0 - y * y)) * sine * sine;
    }
    return min(light.intensity * max(factor, 0.0), vec3(lightMaximum));
}

// Irradiance from a light of any kind at `position` with unit normal n on a face of unit normal `face`, nothing in between.
vec3 lightIrradiance(LightRecord light, vec3 position, vec3 n, vec3 face) {
    if (light.kind == lightKindRectangle) return rectangleLight(light, position, n, face);
    if (light.kind == lightKindSphere) return sphereLight(light, position, n, face);
    vec3 toLight;
    float distanceToLight;
    vec3 facing = punctualLight(light, position, toLight, distanceToLight);
    return leavesFace(toLight, face) ? facing * max(0.0, dot(n, toLight)) : vec3(0.0);
}
