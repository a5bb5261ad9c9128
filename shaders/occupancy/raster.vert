// Throws the scene onto the faces of an occupancy map's cube: along `axis`, or (FACE_BY_TRIANGLE) as raster.geom chooses.
#include "lib/vertex.glsl"
#include "shared/occupancy.h"
#include "shared/triangle_cell.h"

layout(std140) uniform Grid { OccupancyGrid grid; };

#ifdef FACE_BY_TRIANGLE
out vec3 corner_cells;
#else
uniform int axis;
out float cell_depth; // cells along the axis
#endif
#ifdef MATERIAL_MASKED
out vec2 tex_coord;
out vec2 tex_coord1;
out float vertex_alpha;
#endif

void main() {
    vec3 cells = cellsOf(grid, in_position);
#ifdef MATERIAL_MASKED
    tex_coord = in_tex_coord;
    tex_coord1 = in_tex_coord1;
    vertex_alpha = in_colour.a;
#endif
#ifdef FACE_BY_TRIANGLE
    corner_cells = cells;
    gl_Position = vec4(0.0);
#else
    vec3 turned = axisLast(cells, axis);
    cell_depth = turned.z;
    gl_Position = vec4(turned.xy / grid.halfResolution - 1.0, 0.5, 1.0);
#endif
}
