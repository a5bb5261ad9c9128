// The scene's triangles for programs that look them up by number (hits of rays, compute). Reserved names, bound by
// GpuScene to every program that declares them; texel buffers may be declared as imageBuffer (the fastest random read on
// a CPU driver) or, with samplerBuffer, where image units are scarce (define SCENE_BY_SAMPLER):
//   scene_positions            rgba32f   one texel a vertex: render-space position
//   scene_previous_positions   rgba32f   of the last frame
//   scene_vertices             rgba32f   vertexRecordTexels texels a vertex (VertexRecord, shared/scene.h)
//   scene_triangles            rgba32ui  one texel a triangle: three vertices, material
//   scene_cutouts              rgba32ui  cutoutTexels texels a masked triangle (CutoutRecord, shared/scene.h)
//   scene_cutout_alpha         r32ui     one word a texel of an image: its alpha and those right of it, below and both
// or as storage blocks:
//   ScenePositions { vec4[] }, ScenePreviousPositions { vec4[] }, SceneVertices { VertexRecord[] },
//   SceneTriangles { uvec4[] }
// scene_first_masked (uint) is the triangle that has the first record of scene_cutouts.
// And: the blocks Materials and Lights, the samplers scene_colour_textures and scene_data_textures (lib/material.glsl),
// and the uniform scene_first_triangle, the number of the triangle that gl_PrimitiveID 0 is (lib/fragment.glsl).
#include "lib/frame.glsl"
#include "lib/material.glsl"
#include "lib/surface.glsl"
#include "shared/ray.h"

#ifdef SCENE_BY_SAMPLER
uniform samplerBuffer scene_positions;
uniform samplerBuffer scene_vertices;
uniform usamplerBuffer scene_triangles;
uniform usamplerBuffer scene_cutouts;
uniform usamplerBuffer scene_cutout_alpha;
#define SCENE_TEXEL(buffer, index) texelFetch(buffer, int(index))
#else
layout(rgba32f) uniform readonly imageBuffer scene_positions;
layout(rgba32f) uniform readonly imageBuffer scene_vertices;
layout(rgba32ui) uniform readonly uimageBuffer scene_triangles;
layout(rgba32ui) uniform readonly uimageBuffer scene_cutouts;
layout(r32ui) uniform readonly uimageBuffer scene_cutout_alpha;
#define SCENE_TEXEL(buffer, index) imageLoad(buffer, int(index))
#endif

// Three vertices and the material of a triangle.
uvec4 sceneTriangle(uint triangle) { return SCENE_TEXEL(scene_triangles, triangle); }

vec3 scenePosition(uint vertex) { return SCENE_TEXEL(scene_positions, vertex).xyz; }

VertexRecord sceneVertex(uint vertex) {
    uint at = vertex * vertexRecordTexels;
    vec4 coords = SCENE_TEXEL(scene_vertices, at + 2u);
    return VertexRecord(SCENE_TEXEL(scene_vertices, at), SCENE_TEXEL(scene_vertices, at + 1u), coords.xy, coords.zw,
                        SCENE_TEXEL(scene_vertices, at + 3u));
}

// The vertex at barycentric weights (1 - x - y, x, y). The normal is not normalised.
VertexRecord sceneVertexAt(uvec4 triangle, vec2 barycentrics) {
    VertexRecord a = sceneVertex(triangle.x);
    VertexRecord b = sceneVertex(triangle.y);
    VertexRecord c = sceneVertex(triangle.z);
    float u = barycentrics.x;
    float v = barycentrics.y;
    float w = 1.0 - u - v;
    // Handedness is the same at all three, or meaningless in between.
    return VertexRecord(w * a.normal + u * b.normal + v * c.normal,
                        vec4(w * a.tangent.xyz + u * b.tangent.xyz + v * c.tangent.xyz, a.tangent.w),
                        w * a.texCoord + u * b.texCoord + v * c.texCoord,
                        w * a.texCoord1 + u * b.texCoord1 + v * c.texCoord1, w * a.colour + u * b.colour + v * c.colour);
}

#ifdef MATERIAL_MASKED
uniform uint scene_first_masked;

// Alpha of an image at a point, as a sampler reads its finest level.
float cutoutAlpha(vec2 at, uint place, uint size) {
#ifdef MATERIAL_TEXTURES
    vec2 sides = vec2((uvec2(size, size >> cutoutHeightShift) & cutoutSizeMask) + 1u);
    uvec2 wraps = uvec2(size >> cutoutWrapShift, size >> (cutoutWrapShift + 2u)) & 3u;
    // Repeated images go on at their other side; mirrored and clamped ones keep half a texel from the border.
    vec2 mirrored = 1.0 - abs(at - 2.0 * floor(0.5 * at) - 1.0);
    vec2 kept = clamp(mix(at, mirrored, equal(wraps, uvec2(1u))), 0.5 / sides, 1.0 - 0.5 / sides);
    vec2 texel = mix(kept, at - floor(at), equal(wraps, uvec2(0u))) * sides;
    if ((place & cutoutNearest) == 0u) texel -= 0.5;
    vec2 corner = floor(texel);
    vec2 part = texel - corner;
    corner = min(mix(corner, sides - 1.0, lessThan(corner, vec2(0.0))), sides - 1.0);
    uint word = uint(corner.y) * uint(sides.x) + uint(corner.x) + (place & cutoutPlaceMask);
    vec4 alphas = unpackUnorm4x8(SCENE_TEXEL(scene_cutout_alpha, word).r);
    return mix(mix(alphas.x, alphas.y, part.x), mix(alphas.z, alphas.w, part.x), part.y);
#else
    return 1.0;
#endif
}
#endif

// Whether a hit on the triangle counts: the alpha test, compiled in for masked scenes only. materialCovers() for fragments
// says the same but for rounding.
bool sceneCovers(uint triangle, vec2 barycentrics) {
#ifdef MATERIAL_MASKED
    if (triangle < scene_first_masked) return true;
    uint at = cutoutTexels * (triangle - scene_first_masked);
    uvec4 a = SCENE_TEXEL(scene_cutouts, at);
    uvec4 b = SCENE_TEXEL(scene_cutouts, at + 1u);
    vec4 c = uintBitsToFloat(SCENE_TEXEL(scene_cutouts, at + 2u));
    float u = barycentrics.x;
    float v = barycentrics.y;
    float w = 1.0 - u - v;
    vec2 texCoord = w * uintBitsToFloat(a.xy) + u * uintBitsToFloat(a.zw) + v * uintBitsToFloat(b.xy);
    float alpha = (w * c.x + u * c.y + v * c.z) * cutoutAlpha(texCoord, b.z, b.w);
    return alphaCovers(alpha, c.w, (b.z & cutoutBlend) != 0u);
#else
    return true;
#endif
}

// Unit normal of the front side (counter-clockwise); `otherwise` for a triangle without area.
vec3 faceNormal(vec3 p0, vec3 p1, vec3 p2, vec3 otherwise) {
    vec3 a = p1 - p0;
    vec3 b = p2 - p0;
    // Edges of length about 1, or the squares of small scenes would vanish.
    vec3 largest = max(abs(a), abs(b));
    float size = max(largest.x, max(largest.y, largest.z));
    vec3 face = cross(a / size, b / size);
    float area = dot(face, face);
    return area > 0.0 ? face * inversesqrt(area) : otherwise;
}

// What a ray of this direction meets on the triangle, and all of its material there.
Surface sceneSurface(uint triangle, vec2 barycentrics, vec3 direction, out MaterialSample point) {
    uvec4 corners = sceneTriangle(triangle);
    vec3 p0 = scenePosition(corners.x);
    vec3 p1 = scenePosition(corners.y);
    vec3 p2 = scenePosition(corners.z);
    VertexRecord at = sceneVertexAt(corners, barycentrics);
    TexCoords coords = texCoordsAtHit(at.texCoord, at.texCoord1);
    point = materialAt(corners.w, coords, at.colour);

    Surface surface;
    surface.position = p0 + barycentrics.x * (p1 - p0) + barycentrics.y * (p2 - p0);
    surface.error = 0.0;
    surface.normal = faceNormal(p0, p1, p2, -direction);
    surface.front = dot(surface.normal, direction) < 0.0;
    // A vertex normal of zero length, or one that interpolation cancels, tells nothing: the face's does.
    vec3 smoothNormal = dot(at.normal.xyz, at.normal.xyz) > 0.0 ? at.normal.xyz : surface.normal;
    surface.shadingNormal = materialNormal(corners.w, coords, smoothNormal, at.tangent);
    if (!surface.front) {
        surface.normal = -surface.normal;
        surface.shadingNormal = -surface.shadingNormal;
    }
    surface.albedo = point.baseColour.rgb;
    surface.metallic = point.metallic;
    surface.roughness = point.roughness;
    surface.emission = point.emission;
    surface.material = corners.w;
    surface.reach = faceReach(surface.normal, surface.position, p0, p1, p2);
    return surface;
}

Surface sceneSurface(uint triangle, vec2 barycentrics, vec3 direction) {
    MaterialSample point;
    return sceneSurface(triangle, barycentrics, direction, point);
}
