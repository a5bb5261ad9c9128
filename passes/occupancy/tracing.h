// What the tracers through occupancy maps share on this side.
#pragma once
#include "graph/pass.h"
#include <optional>

namespace kestrel {

class Commands;

// The texels that a column of this many words (1, 2, 4 or 8) is read by: one of them, two for eight words.
Format columnFormat(int words);
// How shaders read the columns of a map of so many cells an edge: RESOLUTION and WORDS, and of a texel
// COLUMN_FORMAT (its image format), COLUMN_TYPE (the vector that holds it) and COLUMN_PART (the components of
// what imageLoad gives).
Defines columnDefines(int resolution);

// Whether random reads of a texel buffer can go through image units (measured twice as fast and more on a CPU
// driver); otherwise they go through a storage block.
bool fitsTexels(const Desc& buffer, const Capabilities& capabilities);

// The resolution of the map at input "occupancy". Nothing, and a problem, if it is none.
std::optional<int> mapResolution(const Inputs& inputs, Declaration& declaration);

} // namespace kestrel
