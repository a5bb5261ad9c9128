// An occupancy map in bricks of 2 x 2 x 2 cells, a word each (OccupancyTrace, method `bricks`): the bits of a
// brick's cells, and how far around it nothing is.
//
// Bits 0 to 7: cell (x, y, z) of the brick at bit z << 2 | y << 1 | x. From bit 8 on three bits for each of
// the eight ways that a ray can go (bit k of a way: down along axis k): a code, 0 of a brick that is not
// empty; else, with code c, the cube of 2^(c-1) bricks an edge is empty that begins with this brick and
// extends that way, be it beyond the map.
//
// Bricks are stored row by row, rows along z, then along x.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

const int brickCodes = 7; // the highest

SHARED_END
