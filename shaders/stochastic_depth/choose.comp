// Which texels of a coarse map are traced cell by cell, and the list of their cells that samples fall into.
#include "lib/layers.glsl"
#include "shared/stochastic_depth.h"
#include "shared/work_list.h"
#include <port:coarse>

layout(local_size_x = 8, local_size_y = 8) in;

layout(r32ui) uniform readonly uimage2D sd_cells;
layout(r32ui) uniform writeonly uimage2D chosen;
layout(std430) buffer Texels {
    WorkListHeader header;
    uint items[];
} list;
uniform float edge; // negative: none counts
uniform int density;

float nearestDepth(ivec2 texel) {
    float nearest = noLayer;
    for (int layer = 0; layer < coarse_count; ++layer) nearest = min(nearest, coarse_depth(texel, layer));
    return nearest;
}

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(sd_cells);
    if (any(greaterThanEqual(texel, size))) return;
    uint cells = imageLoad(sd_cells, texel).r;
    if (cells == 0u) return;

    // Texels that nobody asks for tell nothing of edges.
    float own = nearestDepth(texel);
    bool wanted = edge == 0.0 || bitCount(cells) >= density;
    const ivec2 ways[4] = ivec2[](ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1));
    for (int i = 0; i < 4; ++i) {
        ivec2 at = clamp(texel + ways[i], ivec2(0), size - 1);
        float other = nearestDepth(at);
        bool differs = edge >= 0.0 && max(own, other) > (1.0 + edge) * min(own, other);
        wanted = wanted || (differs && imageLoad(sd_cells, at).r != 0u);
    }
    if (!wanted) return;
    imageStore(chosen, texel, uvec4(cells));
    uint count = uint(bitCount(cells));
    uint first = atomicAdd(list.header.count, count);
    atomicMax(list.header.groups.x, (first + count + workListGroup - 1u) / workListGroup);
    while (cells != 0u) {
        ivec2 cell = depthCellsAcross * texel + depthCellAt(findLSB(cells));
        list.items[first] = packPixel(uint(cell.x), uint(cell.y));
        ++first;
        cells &= cells - 1u;
    }
}
