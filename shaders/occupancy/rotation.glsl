// What the ways to make rotated maps share: which maps, and where their cells lie in the base map.
#include "shared/occupancy.h"
#include "shared/roma.h"

#ifdef IN_TURN
// The maps at these places of an order are made anew (Renewal of passes/occupancy/candidates.h).
uniform int firstPlace;
uniform int placeStride;
#define MAP(place) (((firstPlace + (place)) * placeStride) % DIRECTIONS)
#else
#define MAP(place) (place)
#endif

#ifdef LEVELS
// Several base maps one after the other, and their rotated maps likewise; a step rotates one of them.
uniform int level;
#define FIRST_WORD (level * (RESOLUTION * RESOLUTION * WORDS))
#define FIRST_MAP (level * DIRECTIONS)
#define OWN level
#else
#define LEVELS 1
#define FIRST_WORD 0
#define FIRST_MAP 0
#define OWN 0
#endif

const int whole = romaFractionBits;

// The centre of a rotated map's cell in the base map, cells in fixed point: exact, so that all ways to it agree.
ivec3 centreOf(ivec3 cell, ivec3 halfX, ivec3 halfY, ivec3 halfZ) {
    ivec3 twice = 2 * cell + (1 - RESOLUTION);
    return ivec3((RESOLUTION / 2) << whole) + twice.x * halfX + twice.y * halfY + twice.z * halfZ;
}
