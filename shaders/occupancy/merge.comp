// The union of the columns along x, y and z (raster.frag, INTO_COLUMNS): one invocation makes one word of the map.
#include "shared/occupancy.h"
#include "shared/triangle_cell.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(rgba32ui) readonly uniform uimage2D columns_x;
layout(rgba32ui) readonly uniform uimage2D columns_y;
layout(rgba32ui) readonly uniform uimage2D columns_z;
#if RESOLUTION > 128
layout(rgba32ui) readonly uniform uimage2D columns_x_high;
layout(rgba32ui) readonly uniform uimage2D columns_y_high;
layout(rgba32ui) readonly uniform uimage2D columns_z_high;
#define COLUMNS(low, high, pixel, w) ((w) < 4 ? imageLoad(low, pixel)[(w) & 3] : imageLoad(high, pixel)[(w) & 3])
#else
#define COLUMNS(low, high, pixel, w) imageLoad(low, pixel)[(w) & 3]
#endif

layout(std430) writeonly buffer Occupancy { uint occupancy[]; };

void main() {
    ivec3 id = ivec3(gl_GlobalInvocationID); // x, y, word
    uint word = COLUMNS(columns_z, columns_z_high, id.xy, id.z);
    for (int i = 0; i < 32; ++i) {
        // The image of an axis shows the other two in the order of axisLast().
        int z = 32 * id.z + i;
        uint alongX = COLUMNS(columns_x, columns_x_high, ivec2(id.y, z), id.x >> 5) >> uint(id.x & 31);
        uint alongY = COLUMNS(columns_y, columns_y_high, ivec2(z, id.x), id.y >> 5) >> uint(id.y & 31);
        word |= ((alongX | alongY) & 1u) << i;
    }
    occupancy[occupancyWord(id.x, id.y, 32 * id.z, RESOLUTION)] = word;
}
