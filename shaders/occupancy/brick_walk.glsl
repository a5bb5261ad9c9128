// Part of the module of occupancy/occupancy_trace.glsl: a step from brick to brick (shared/occupancy_bricks.h).
//
// One word tells of an empty cube that begins where the ray is and extends the way that it goes, so that a walk has no levels
// to go up and down, and a step has half the instructions of one over columns. Bricks of 4 x 4 x 4 bits beside such codes, four
// words of which a step loads three and builds masks for 64 bits, took as many steps of nearly twice the length.

// Whether the cell is occupied, and where the cube that begins with its brick, or if the brick is not empty the cell, is
// left: when, and in which cell.
float M(brickStep)(M(Line) line, ivec3 at, out bool found, out ivec3 onward) {
    ivec3 brick = at >> 1;
    int index = (brick.y << (2 * BRICK_BITS) | brick.x << BRICK_BITS | brick.z) ^ line.flipIndex;
    uint word = MAP_WORD(index);
    int place = ((at.z & 1) << 2 | (at.y & 1) << 1 | at.x & 1) ^ line.flipPlace;
    found = (word >> uint(place) & 1u) != 0u;
    int code = int(word >> uint(line.way) & 7u);
    ivec3 planes = (at & ~min(code, 1)) + (1 << code);

    vec3 next = (vec3(planes) - line.origin) * line.inverse;
    float leave = next.x < next.y ? next.x : next.y;
    leave = next.z < leave ? next.z : leave;
    bool alongZ = next.z <= leave;
    bool alongX = next.x <= leave && !alongZ;
    bool alongY = !alongX && !alongZ;
    // Of planes passed at one time, those along z come first, then x, then y.
    int x = M(cellAtTime)(line.origin.x, line.direction.x, line.inverse.x, at.x, leave, alongY);
    int y = M(cellAtTime)(line.origin.y, line.direction.y, line.inverse.y, at.y, leave, false);
    int z = M(cellAtTime)(line.origin.z, line.direction.z, line.inverse.z, at.z, leave, true);
    onward = ivec3(alongX ? planes.x : x, alongY ? planes.y : y, alongZ ? planes.z : z);
    return leave;
}
