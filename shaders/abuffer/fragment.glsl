// What a fragment of abuffer/scene.vert has to say of its triangle: whether it is there, and at which depth along the
// view's axis. BY_RAYS, in the frame's view: as the ray through the pixel's middle meets the triangle, for which
// abuffer/by_rays.geom offers fragments; elsewhere as the rasterizer finds it.
#include "lib/fragment.glsl"
#include "abuffer/seen.glsl"

#ifdef BY_NUMBER
flat in uint seen_triangle;
uint abufferTriangle() { return seen_triangle; }
#else
uint abufferTriangle() { return fragmentTriangle(); }
#endif

#if defined(BY_RAYS) && !defined(CUBE)
#include "lib/view.glsl"
#include "shared/triangle.h"

layout(std140) uniform VIEW_BLOCK { ViewData frameView; };

bool abufferFragment(out float depth) {
    vec3 origin, direction;
    float tNear, tFar;
    cameraRay(frameView, floor(gl_FragCoord.xy) + 0.5, origin, direction, tNear, tFar);
    uint triangle = abufferTriangle();
    uvec4 corners = sceneTriangle(triangle);
    TriangleHit hit;
    bool met = intersectTriangle(triangleRay(origin, direction), tNear, tFar, scenePosition(corners.x), scenePosition(corners.y),
                                 scenePosition(corners.z), hit);
    depth = hit.t * -(mat3(frameView.view) * direction).z;
    return met && sceneCovers(triangle, vec2(hit.u, hit.v));
}
#else
in SEEN seen;

bool abufferFragment(out float depth) {
    depth = seen.depth;
#ifdef MATERIAL_MASKED
    return materialCovers(sceneTriangle(abufferTriangle()).w, seen.texCoord, seen.texCoord1, seen.alpha);
#else
    return true;
#endif
}
#endif
