// Throws each triangle onto the face of the cube where it covers most, so that one pass leaves few holes.
#include "shared/occupancy.h"
#include "shared/triangle_cell.h"

layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

layout(std140) uniform Grid { OccupancyGrid grid; };

in vec3 corner_cells[];
out float cell_depth;
flat out int face_axis;
#ifdef MATERIAL_MASKED
in vec2 tex_coord[];
in vec2 tex_coord1[];
in float vertex_alpha[];
out vec2 face_tex_coord;
out vec2 face_tex_coord1;
out float face_vertex_alpha;
#endif

void main() {
    int axis = steepestAxis(cross(corner_cells[1] - corner_cells[0], corner_cells[2] - corner_cells[0]));
    for (int i = 0; i < 3; ++i) {
        vec3 turned = axisLast(corner_cells[i], axis);
        cell_depth = turned.z;
        face_axis = axis;
        gl_PrimitiveID = gl_PrimitiveIDIn;
        gl_Position = vec4(turned.xy / grid.halfResolution - 1.0, 0.5, 1.0);
#ifdef MATERIAL_MASKED
        face_tex_coord = tex_coord[i];
        face_tex_coord1 = tex_coord1[i];
        face_vertex_alpha = vertex_alpha[i];
#endif
        EmitVertex();
    }
    EndPrimitive();
}
