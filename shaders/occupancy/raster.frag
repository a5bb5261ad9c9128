// Sets the bit of the cell that a fragment lies in. How the bits of one column come together without a race:
//   INTO_MAP        atomically in the map itself
//   INTO_COLUMNS    one axis's columns as integers of an image each, by the logic operation of the framebuffer; or with
//     BY_FETCH      by reading the attachment back, which orders the fragments of a pixel (a rasterizer-ordered view)
//     BY_INTERLOCK  in a critical section over the pixel (the other form of it)
#ifdef BY_FETCH
#extension GL_EXT_shader_framebuffer_fetch : require
#endif
#ifdef BY_INTERLOCK
#extension GL_ARB_fragment_shader_interlock : require
#endif
#ifdef MATERIAL_MASKED
#include "lib/fragment.glsl"
#endif
#include "shared/occupancy.h"
#include "shared/triangle_cell.h"

in float cell_depth;
uniform float inset; // cells along the axis

#ifdef FACE_BY_TRIANGLE
flat in int face_axis;
#define FACE_AXIS face_axis
#else
uniform int axis;
#define FACE_AXIS axis
#endif

#ifdef MATERIAL_MASKED
#ifdef FACE_BY_TRIANGLE
in vec2 face_tex_coord;
in vec2 face_tex_coord1;
in float face_vertex_alpha;
bool covers() { return materialCovers(fragmentMaterial(), face_tex_coord, face_tex_coord1, face_vertex_alpha); }
#else
in vec2 tex_coord;
in vec2 tex_coord1;
in float vertex_alpha;
bool covers() { return materialCovers(fragmentMaterial(), tex_coord, tex_coord1, vertex_alpha); }
#endif
#else
bool covers() { return true; }
#endif

#ifdef INTO_MAP
layout(std430) buffer Occupancy { uint occupancy[]; };
#elif defined(BY_INTERLOCK)
layout(pixel_interlock_ordered) in;
layout(rgba32ui) uniform coherent uimage2D COLUMNS_LOW;
#ifdef COLUMNS_HIGH
layout(rgba32ui) uniform coherent uimage2D COLUMNS_HIGH;
#endif
#elif defined(BY_FETCH)
inout uvec4 COLUMNS_LOW;
#ifdef COLUMNS_HIGH
inout uvec4 COLUMNS_HIGH;
#endif
#else
out uvec4 COLUMNS_LOW;
#ifdef COLUMNS_HIGH
out uvec4 COLUMNS_HIGH;
#endif
#endif

// Word `first` to `first` + 3 of a column with bit z set.
uvec4 columnBit(int z, int first) {
    uvec4 word = uvec4(equal(ivec4(z >> 5), ivec4(first) + ivec4(0, 1, 2, 3)));
    return word << uint(z & 31);
}

void main() {
    // Behind the surface, as the triangle is wound: the normals of front faces point along the axis, to greater depth.
    float behind = gl_FrontFacing ? -inset : inset;
    int z = clamp(int(floor(cell_depth + behind)), 0, RESOLUTION - 1);
    bool there = covers();
#ifdef INTO_MAP
    if (!there) discard;
    ivec3 cell = axisBack(ivec3(gl_FragCoord.xy, z), FACE_AXIS);
    atomicOr(occupancy[occupancyWord(cell.x, cell.y, cell.z, RESOLUTION)], 1u << uint(cell.z & 31));
#elif defined(BY_INTERLOCK)
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uvec4 low = there ? columnBit(z, 0) : uvec4(0u);
    uvec4 high = there ? columnBit(z, 4) : uvec4(0u);
    beginInvocationInterlockARB();
    imageStore(COLUMNS_LOW, pixel, imageLoad(COLUMNS_LOW, pixel) | low);
#ifdef COLUMNS_HIGH
    imageStore(COLUMNS_HIGH, pixel, imageLoad(COLUMNS_HIGH, pixel) | high);
#endif
    endInvocationInterlockARB();
#else
    if (!there) discard;
#ifdef BY_FETCH
    COLUMNS_LOW |= columnBit(z, 0);
#ifdef COLUMNS_HIGH
    COLUMNS_HIGH |= columnBit(z, 4);
#endif
#else
    COLUMNS_LOW = columnBit(z, 0);
#ifdef COLUMNS_HIGH
    COLUMNS_HIGH = columnBit(z, 4);
#endif
#endif
#endif
}
