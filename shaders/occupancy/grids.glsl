// Where the cells of the base map lie, GRID of the level at hand.
#if LEVELS > 1
layout(std140) uniform Grids { OccupancyGrid grids[LEVELS]; };
#define GRID grids[OWN]
#else
layout(std140) uniform Grid { OccupancyGrid grid; };
#define GRID grid
#endif
