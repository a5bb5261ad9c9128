// Brings the words of each column of the base map together (shared/occupancy.h): one invocation a column. With COARSER, a
// column of a coarser level is the union of 2 x 2 columns of the level before: one step a level.
#include "shared/occupancy.h"

layout(local_size_x = 8, local_size_y = 8) in;

const int texels = (WORDS + 3) / 4; // a column

#ifdef COARSER

layout(std430) buffer Columns { COLUMN_TYPE columns[]; };
uniform int level; // that is made

void main() {
    int size = RESOLUTION >> level;
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (max(at.x, at.y) >= size) return;
    int finer = occupancyLevelStart(level - 1, RESOLUTION) + 2 * (at.y * 2 * size + at.x);
    int coarser = occupancyLevelStart(level, RESOLUTION) + at.y * size + at.x;
    for (int i = 0; i < texels; ++i)
        columns[texels * coarser + i] = columns[texels * finer + i] | columns[texels * (finer + 1) + i] |
                                        columns[texels * (finer + 2 * size) + i] |
                                        columns[texels * (finer + 2 * size + 1) + i];
}

#else

layout(std430) readonly buffer Occupancy { uint occupancy[]; };
layout(std430) writeonly buffer Columns { COLUMN_TYPE columns[]; };

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    uint words[WORDS];
    for (int w = 0; w < WORDS; ++w) words[w] = occupancy[occupancyWord(at.x, at.y, 32 * w, RESOLUTION)];
    int index = at.y * RESOLUTION + at.x;
#if WORDS == 1
    columns[index] = words[0];
#elif WORDS == 2
    columns[index] = uvec2(words[0], words[1]);
#elif WORDS == 4
    columns[index] = uvec4(words[0], words[1], words[2], words[3]);
#else
    columns[2 * index] = uvec4(words[0], words[1], words[2], words[3]);
    columns[2 * index + 1] = uvec4(words[4], words[5], words[6], words[7]);
#endif
}

#endif
