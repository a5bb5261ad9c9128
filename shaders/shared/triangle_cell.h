// Triangles against the cells of a grid, the same formulas on both sides of the C++/GLSL border.
//
// Everything is in cell coordinates (shared/occupancy.h): a cell is a unit cube with integer corners.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

// Does the triangle, given relative to the centre of a unit cube, meet the closed cube? The separating axis theorem on
// the cube's three axes, the triangle's normal and the nine crossed edges (Akenine-Möller, "Fast 3D Triangle-Box Overlap
// Testing", 2001). Touching counts: a surface exactly between two cells occupies both, so that nothing slips through.
// A triangle without area is the segment or the point that it is.
inline bool axisSeparates(vec3 axis, vec3 a, vec3 b, vec3 c) {
    float pa = dot(axis, a);
    float pb = dot(axis, b);
    float pc = dot(axis, c);
    float radius = 0.5f * (abs(axis.x) + abs(axis.y) + abs(axis.z));
    return min(pa, min(pb, pc)) > radius || max(pa, max(pb, pc)) < -radius;
}

inline bool triangleMeetsCube(vec3 a, vec3 b, vec3 c) {
    vec3 low = min(a, min(b, c));
    vec3 high = max(a, max(b, c));
    if (max(low.x, max(low.y, low.z)) > 0.5f || min(high.x, min(high.y, high.z)) < -0.5f) return false;
    vec3 ab = b - a;
    vec3 bc = c - b;
    vec3 ca = a - c;
    vec3 normal = cross(ab, bc);
    if (abs(dot(normal, a)) > 0.5f * (abs(normal.x) + abs(normal.y) + abs(normal.z))) return false;
    bool apart = axisSeparates(vec3(0.0f, -ab.z, ab.y), a, b, c) || axisSeparates(vec3(0.0f, -bc.z, bc.y), a, b, c) ||
                 axisSeparates(vec3(0.0f, -ca.z, ca.y), a, b, c) || axisSeparates(vec3(ab.z, 0.0f, -ab.x), a, b, c) ||
                 axisSeparates(vec3(bc.z, 0.0f, -bc.x), a, b, c) || axisSeparates(vec3(ca.z, 0.0f, -ca.x), a, b, c) ||
                 axisSeparates(vec3(-ab.y, ab.x, 0.0f), a, b, c) || axisSeparates(vec3(-bc.y, bc.x, 0.0f), a, b, c) ||
                 axisSeparates(vec3(-ca.y, ca.x, 0.0f), a, b, c);
    return !apart;
}

// The cells that a triangle may meet, column by column along the axis that its normal is steepest in: there the plane
// climbs at most one cell a cell, so that few cells stand over each other.
struct TriangleWalk {
    ivec3 first; // of the bounding box, inclusive; x and y count columns, z the cells in them, axes permuted
    ivec3 last;
    int axis;    // that z stands for: 0, 1, 2
    vec3 plane;  // z = plane.x x + plane.y y + plane.z over the plane
    float slack; // half of what the plane climbs over a column, and the uncertainty of its slope over the box
};

// The axis that a normal is steepest in.
inline int steepestAxis(vec3 normal) {
    vec3 steep = abs(normal);
    return steep.x > max(steep.y, steep.z) ? 0 : (steep.y > steep.z ? 1 : 2);
}

// Takes (x, y, z) to (y, z, x), (z, x, y) or itself, so that `axis` comes last.
inline vec3 axisLast(vec3 p, int axis) {
    return axis == 0 ? vec3(p.y, p.z, p.x) : (axis == 1 ? vec3(p.z, p.x, p.y) : p);
}
inline ivec3 axisBack(ivec3 p, int axis) {
    return axis == 0 ? ivec3(p.z, p.x, p.y) : (axis == 1 ? ivec3(p.y, p.z, p.x) : p);
}

// The walk over a triangle in a grid of resolution^3 cells; columns outside the grid are clipped off. Slivers and
// triangles without area have an uncertain normal: their slack grows until it covers the whole bounding box.
inline TriangleWalk triangleWalk(vec3 a, vec3 b, vec3 c, int resolution) {
    vec3 normal = cross(b - a, c - a);
    TriangleWalk walk;
    walk.axis = steepestAxis(normal);
    vec3 pa = axisLast(a, walk.axis);
    vec3 pb = axisLast(b, walk.axis);
    vec3 pc = axisLast(c, walk.axis);
    vec3 n = axisLast(normal, walk.axis);
    vec3 low = min(pa, min(pb, pc));
    vec3 high = max(pa, max(pb, pc));
    // A cell that is touched from above counts, and so may one that rounding makes touched.
    const float touch = 0.001f;
    float size = float(resolution);
    walk.first = ivec3(floor(clamp(low - vec3(touch), vec3(0.0f), vec3(size))));
    walk.last = ivec3(floor(clamp(high + vec3(touch), vec3(-1.0f), vec3(size - 1.0f))));
    vec3 extent = high - low;
    // Products of lengths up to `longest` round by 6e-8 of their size each; 1e-6 covers their sum.
    float longest = max(extent.x, max(extent.y, extent.z));
    float doubt = 1e-6f * longest * longest;
    float climb = abs(n.z);
    if (climb > doubt) {
        walk.plane.x = -n.x / n.z;
        walk.plane.y = -n.y / n.z;
        walk.plane.z = pa.z - walk.plane.x * pa.x - walk.plane.y * pa.y;
        walk.slack = 0.5f * (abs(walk.plane.x) + abs(walk.plane.y)) + touch +
                     2.0f * doubt / (climb - doubt) * (extent.x + extent.y + 2.0f);
    } else {
        walk.plane = vec3(0.0f, 0.0f, pa.z);
        walk.slack = extent.z + 1.0f;
    }
    return walk;
}

// The cells of column (x, y) that the plane may pass: first and last, both inclusive.
inline ivec2 walkColumn(TriangleWalk walk, int x, int y) {
    float z = walk.plane.x * (float(x) + 0.5f) + walk.plane.y * (float(y) + 0.5f) + walk.plane.z;
    float low = max(z - walk.slack, float(walk.first.z));
    float high = min(z + walk.slack, float(walk.last.z));
    return ivec2(int(floor(low)), int(floor(high)));
}

// What else may be marked than all cells that a triangle meets: those that it passes in the columns whose middle lines meet
// it, along the axis that its normal is steepest in. Thin things come out as thick as they are in the mean over their place,
// as rasterized along that axis; and a step from cell to cell, also across an edge or a corner, that crosses the inside of a
// surface meets a marked cell (26-separating: Laine, "A Topological Approach to Voxelization", 2013), which what is rasterized
// along three axes promises for steps across faces alone. At creases, where columns of two axes meet, a cell may be lacking.

// Does the middle line of column (x, y) meet the triangle? What lies on an edge counts on both sides of it, a
// triangle without area nowhere.
inline bool columnMeets(TriangleWalk walk, vec3 a, vec3 b, vec3 c, int x, int y) {
    const vec2 centre = vec2(float(x) + 0.5f, float(y) + 0.5f);
    const vec3 la = axisLast(a, walk.axis);
    const vec3 lb = axisLast(b, walk.axis);
    const vec3 lc = axisLast(c, walk.axis);
    const vec2 pa = vec2(la.x, la.y) - centre;
    const vec2 pb = vec2(lb.x, lb.y) - centre;
    const vec2 pc = vec2(lc.x, lc.y) - centre;
    const float onAb = pa.x * pb.y - pa.y * pb.x;
    const float onBc = pb.x * pc.y - pb.y * pc.x;
    const float onCa = pc.x * pa.y - pc.y * pa.x;
    const bool inside = min(onAb, min(onBc, onCa)) >= 0.0f || max(onAb, max(onBc, onCa)) <= 0.0f;
    return inside && onAb + onBc + onCa != 0.0f;
}

// The cells of column (x, y) that the plane passes, from side to side of the column and no farther than the triangle
// reaches: first and last, both inclusive.
inline ivec2 throughColumn(TriangleWalk walk, int x, int y) {
    const float z = walk.plane.x * (float(x) + 0.5f) + walk.plane.y * (float(y) + 0.5f) + walk.plane.z;
    const float climb = 0.5f * (abs(walk.plane.x) + abs(walk.plane.y));
    const float low = max(z - climb, float(walk.first.z));
    const float high = min(z + climb, float(walk.last.z));
    return ivec2(int(floor(low)), int(floor(high)));
}

// How far to move a triangle so that it lies `inset` cells behind its face, along the axis that its normal is steepest in.
inline vec3 behindFace(vec3 a, vec3 b, vec3 c, float inset) {
    const vec3 normal = cross(b - a, c - a);
    const int axis = steepestAxis(normal);
    return axis == 0   ? vec3(-inset * sign(normal.x), 0.0f, 0.0f)
           : axis == 1 ? vec3(0.0f, -inset * sign(normal.y), 0.0f)
                       : vec3(0.0f, 0.0f, -inset * sign(normal.z));
}

SHARED_END
