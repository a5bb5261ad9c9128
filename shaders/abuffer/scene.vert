// The scene's triangles in a view of the A-buffer: in VIEW, or each instance in another one (SEVERAL_VIEWS). With a geometry
// stage behind this one gl_Position holds the place in render space (GEOMETRY_SHADER).
//
// BY_NUMBER: vertices are fetched, not given (DrawState::byNumber), three for each triangle, so that a fragment knows its triangle
// without gl_PrimitiveID, which costs llvmpipe more than all else that a fragment is stored by; where there are more
// triangles than fragments, three vertices in place of one cost about as much.
#ifdef VERTEX_LAYER
#extension GL_ARB_shader_viewport_layer_array : require
#endif
#include "abuffer/views.glsl"
#include "abuffer/seen.glsl"
#ifdef BY_NUMBER
#include "lib/scene.glsl"
#else
#include "lib/vertex.glsl"
#endif

#ifdef CUBE
uniform uint face;
#endif

// With and without numbers the same pixels are covered.
invariant gl_Position;
out SEEN seen;
#ifdef BY_NUMBER
flat out uint TRIANGLE_HERE;
#if defined(PLANES) && !defined(GEOMETRY_SHADER)
flat out vec2 seen_range;
#endif
#endif

void main() {
#ifdef BY_NUMBER
    TRIANGLE_HERE = uint(gl_VertexID) / 3u;
    uvec4 corners = sceneTriangle(TRIANGLE_HERE);
    uint vertex = corners[gl_VertexID % 3];
    vec3 position = scenePosition(vertex);
#else
    vec3 position = in_position;
#endif
#if defined(MATERIAL_MASKED) && defined(BY_NUMBER)
    VertexRecord record = sceneVertex(vertex);
    seen.texCoord = record.texCoord;
    seen.texCoord1 = record.texCoord1;
    seen.alpha = record.colour.a;
#elif defined(MATERIAL_MASKED)
    seen.texCoord = in_tex_coord;
    seen.texCoord1 = in_tex_coord1;
    seen.alpha = in_colour.a;
#endif
#ifdef GEOMETRY_SHADER
    seen.depth = 0.0;
    seen.view = 0u;
    gl_Position = vec4(position, 1.0);
#else
#ifdef VERTEX_LAYER
    uint view = uint(FIRST_VIEW + gl_InstanceID);
    seen.view = view;
#ifdef LAYERED
    gl_Layer = int(view) - 1;
#else
    gl_ViewportIndex = view == 0u ? 0 : 1;
#endif
#else
    uint view = VIEW;
#endif
    gl_Position = seenFrom(view, position, seen.depth);
#if defined(PLANES) && defined(BY_NUMBER)
    seen_range = depthsOf(view, scenePosition(corners.x), scenePosition(corners.y), scenePosition(corners.z));
#endif
#endif
}
