// A list that one program fills and others work off by indirect dispatch: the header that lies before its items.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

struct WorkListHeader {
    uint count; // of items
    uint pad0;
    uint pad1;
    uint pad2;
    uvec4 groups; // work groups of workListGroup invocations for all of them, an indirect command
};

const uint workListGroup = 64u;

// An item that is a pixel or texel.
inline uint packPixel(uint x, uint y) { return x | (y << 16u); }
inline ivec2 unpackPixel(uint item) { return ivec2(int(item & 0xffffu), int(item >> 16u)); }

SHARED_END
