// Words of a base map.
#ifdef BASE_STORAGE
layout(std430) readonly buffer Occupancy { uint occupancy[]; };
#define BASE_WORD(index) occupancy[index]
#else
layout(r32ui) readonly uniform uimageBuffer occupancy;
#define BASE_WORD(index) imageLoad(occupancy, index).x
#endif
