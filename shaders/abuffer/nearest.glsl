// Where a fragment's triangle is nearest to a place, since a hit lies somewhere in the fragment's pixel.
#include "lib/scene.glsl"

// The triangle's barycentric weights (of its second and third corner) where its plane is nearest to `place`, in render
// space, moved into the triangle.
vec2 abufferNearest(uint triangle, vec3 place) {
    uvec4 corners = sceneTriangle(triangle);
    vec3 p0 = scenePosition(corners.x);
    vec3 a = scenePosition(corners.y) - p0;
    vec3 b = scenePosition(corners.z) - p0;
    vec3 p = place - p0;
    float aa = dot(a, a);
    float ab = dot(a, b);
    float bb = dot(b, b);
    float area = aa * bb - ab * ab;
    vec2 barycentrics = vec2(0.0);
    if (area > 0.0)
        barycentrics = vec2(bb * dot(p, a) - ab * dot(p, b), aa * dot(p, b) - ab * dot(p, a)) / area;
    barycentrics = max(barycentrics, vec2(0.0));
    return barycentrics / max(barycentrics.x + barycentrics.y, 1.0);
}
