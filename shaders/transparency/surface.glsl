// A blended surface as a ray from the eye meets it: its colour by the light of the program's module `radiance` (RADIANCE) and
// from all sides (AMBIENT), and its alpha. Textures are read at their finest level, as for all hits of rays.
#include "lib/scene.glsl"
#include "lib/tracer.glsl"
#include "shared/triangle.h"

#ifdef AMBIENT
uniform vec3 ambient;
#endif

// False where the triangle's material is not blended, or has one side that the ray does not come to.
bool blendedSurface(uint triangle, vec3 origin, vec3 direction, out vec3 colour, out float alpha) {
    colour = vec3(0.0);
    alpha = 0.0;
    uvec4 corners = sceneTriangle(triangle);
    uint flags = scene_materials[corners.w].flags;
    if ((flags & materialFlagBlend) == 0u) return false;
    TriangleHit hit;
    intersectTriangle(triangleRay(origin, direction), 0.0, rayInfinity, scenePosition(corners.x), scenePosition(corners.y),
                      scenePosition(corners.z), hit);
    // A rasterizer, which rounds corners to parts of a pixel, finds triangles that the ray passes: by so little that the nearest
    // place is as good. A triangle seen along its plane has no such place; its middle stands for it.
    vec2 place = vec2(hit.u, hit.v);
    place = mix(vec2(1.0 / 3.0), place, lessThan(abs(place), vec2(1e6)));
    place = max(place, vec2(0.0));
    place /= max(place.x + place.y, 1.0);
    MaterialSample point;
    Surface at = sceneSurface(triangle, place, direction, point);
    if (!at.front && (flags & materialFlagDoubleSided) == 0u) return false;
    alpha = clamp(point.baseColour.a, 0.0, 1.0);
    if (point.unlit) {
        colour = at.albedo + at.emission;
        return true;
    }
#ifdef RADIANCE
    colour += radiance_surface(at, -direction);
#endif
#ifdef AMBIENT
    colour += at.albedo * (1.0 - at.metallic) * ambient;
#endif
    return true;
}
