// The scene's triangles in a view of the A-buffer: in VIEW, or each instance in another one (SEVERAL_VIEWS). With
// GEOMETRY_SHADER the stage after this one puts them into the views, and gl_Position holds the place in render space.
#ifdef VERTEX_LAYER
#extension GL_ARB_shader_viewport_layer_array : require
#endif
#include "lib/vertex.glsl"
#include "abuffer/views.glsl"
#include "abuffer/seen.glsl"

#ifdef CUBE
uniform uint face;
#endif

out SEEN seen;

void main() {
#ifdef MATERIAL_MASKED
    seen.texCoord = in_tex_coord;
    seen.texCoord1 = in_tex_coord1;
    seen.alpha = in_colour.a;
#endif
#ifdef GEOMETRY_SHADER
    seen.depth = 0.0;
    seen.view = 0u;
    gl_Position = vec4(in_position, 1.0);
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
    gl_Position = seenFrom(view, in_position, seen.depth);
#endif
}
