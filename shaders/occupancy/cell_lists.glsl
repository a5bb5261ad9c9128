// The occupied cells of each level's base map, LIST those of the level at hand.
#include "shared/occupied_cells.h"

struct CellList {
    OccupiedCellsHeader header;
    uint cells[CELLS];
};
layout(std430) buffer Cells { CellList lists[LEVELS]; };
#define LIST lists[OWN]
