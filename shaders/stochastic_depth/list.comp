// Lists the pixels of an image of whole numbers that are not 0: the image WANTED, of WANTED_FORMAT, into the block LIST.
#include "shared/work_list.h"

layout(local_size_x = 64) in;

layout(WANTED_FORMAT) uniform readonly uimage2D WANTED;
layout(std430) buffer LIST {
    WorkListHeader header;
    uint items[];
} list;

const int run = 8; // pixels of a row that each invocation looks at, so that few atomics meet

void main() {
    ivec2 size = imageSize(WANTED);
    ivec2 first = ivec2(int(gl_GlobalInvocationID.x) * run, int(gl_GlobalInvocationID.y));
    if (first.x >= size.x || first.y >= size.y) return;
    uint wanted = 0u;
    for (int i = 0; i < run; ++i)
        if (first.x + i < size.x && imageLoad(WANTED, first + ivec2(i, 0)).r != 0u) wanted |= 1u << i;
    uint count = uint(bitCount(wanted));
    if (count == 0u) return;
    uint at = atomicAdd(list.header.count, count);
    atomicMax(list.header.groups.x, (at + count + workListGroup - 1u) / workListGroup);
    while (wanted != 0u) {
        list.items[at] = packPixel(uint(first.x + findLSB(wanted)), uint(first.y));
        ++at;
        wanted &= wanted - 1u;
    }
}
