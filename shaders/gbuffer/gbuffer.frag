// Each OUT_… define switches one output on; what nobody reads is not computed.
#include "lib/fragment.glsl"
#include "lib/view.glsl"
#include "shared/bsdf.h"
#include "shared/ray.h"
#ifdef OUT_MOTION
#include "lib/last_view.glsl"
#endif

layout(std140) uniform DepthView { ViewData depthView; };

in vec3 v_position;
in vec3 v_normal;
in vec2 v_tex_coord;
in vec2 v_tex_coord1;
#ifdef MATERIAL_NORMAL_MAPS
in vec4 v_tangent;
#endif
#ifdef MATERIAL_COLOURS
in vec4 v_colour;
#endif
#ifdef MOVES
in vec3 v_previous_position;
#endif

#ifdef OUT_VIEW_DEPTH
out float out_view_depth;
#endif
#ifdef OUT_NORMAL
out vec4 out_normal;
#endif
#ifdef OUT_FACE_NORMAL
out vec4 out_face_normal;
#endif
#ifdef OUT_POSITION
out vec4 out_position;
#endif
#ifdef OUT_ALBEDO
out vec4 out_albedo;
#endif
#ifdef OUT_MATERIAL
out vec4 out_material;
#endif
#ifdef OUT_EMISSION
out vec4 out_emission;
#endif
#ifdef OUT_REFRACTION
out vec2 out_refraction;
#endif
#ifdef OUT_MOTION
out vec2 out_motion;
#endif
#ifdef OUT_COVERAGE
out float out_coverage;
#endif

void main() {
    TexCoords coords = fragmentTexCoords(v_tex_coord, v_tex_coord1);
    uint material = fragmentMaterial();
#ifdef MATERIAL_COLOURS
    vec4 colour = v_colour;
#else
    vec4 colour = vec4(1.0);
#endif
#ifdef MATERIAL_MASKED
    if (!materialCovers(material, v_tex_coord, v_tex_coord1, colour.a)) discard;
#endif
#if defined(OUT_NORMAL) || defined(OUT_FACE_NORMAL) || defined(OUT_REFRACTION)
    vec3 eye = towardsEye(depthView, v_position);
    // From the corners, not from derivatives: those are noise where a triangle is thinner than a pixel.
    uvec4 corners = sceneTriangle(fragmentTriangle());
    vec3 face = faceNormal(scenePosition(corners.x), scenePosition(corners.y), scenePosition(corners.z), eye);
    float side = dot(face, eye) < 0.0 ? -1.0 : 1.0;
#endif
#ifdef OUT_NORMAL
#ifdef MATERIAL_NORMAL_MAPS
    vec4 tangent = v_tangent;
#else
    vec4 tangent = vec4(0.0);
#endif
    vec3 smoothNormal = dot(v_normal, v_normal) > 0.0 ? v_normal : face;
    vec3 shading = side * materialNormal(material, coords, smoothNormal, tangent);
    // A coarse mesh's smooth normal can look away from the eye at a silhouette; the face never does.
    // What the depth misplaces the point by: of a triangle that reaches far beyond the image, a rasterizer's depth is off by
    // much more than its last bit.
    vec3 misplaced = positionFromDepth(depthView, gl_FragCoord.xy, gl_FragCoord.z) - v_position;
    out_normal = vec4(dot(shading, eye) > 0.0 ? shading : side * face, min(abs(dot(face, misplaced)), 65504.0));
#endif
#ifdef OUT_FACE_NORMAL
    vec3 extent = abs(v_position);
    float reach = faceReach(face, v_position, scenePosition(corners.x), scenePosition(corners.y), scenePosition(corners.z));
    float off = rayStart(distance(depthView.position.xyz, v_position), max(extent.x, max(extent.y, extent.z)), reach);
    out_face_normal = vec4(side * face, off);
#endif
#ifdef OUT_VIEW_DEPTH
    out_view_depth = -(depthView.view * vec4(v_position, 1.0)).z;
#endif
#ifdef OUT_POSITION
    out_position = vec4(v_position, 1.0);
#endif
#if defined(OUT_ALBEDO) || defined(OUT_MATERIAL) || defined(OUT_EMISSION) || defined(OUT_REFRACTION)
    MaterialSample point = materialAt(material, coords, colour);
#endif
#ifdef OUT_ALBEDO
    out_albedo = vec4(point.baseColour.rgb, 1.0);
#endif
#ifdef OUT_MATERIAL
    out_material = vec4(point.roughness, point.metallic, point.unlit ? 1.0 : 0.0, 0.0);
#endif
#ifdef OUT_EMISSION
    out_emission = vec4(min(point.emission, vec3(65504.0)), 0.0); // the largest half float, never infinity
#endif
#ifdef OUT_REFRACTION
    out_refraction = vec2(point.transmission, relativeIndex(point.ior, side > 0.0));
#endif
#ifdef OUT_MOTION
#ifdef MOVES
    vec3 before = v_previous_position;
#else
    vec3 before = v_position;
#endif
    vec2 now = gl_FragCoord.xy + depthView.jitter; // what the sample at the centre sees stands there without jitter
    vec2 then;
    // What stood behind the eye has no pixel in the last frame: one that is far outside of it.
    bool seen = projectPrevious(depthView, before, then);
    out_motion = seen ? then - now : vec2(1e6);
#endif
#ifdef OUT_COVERAGE
    out_coverage = 1.0;
#endif
}
