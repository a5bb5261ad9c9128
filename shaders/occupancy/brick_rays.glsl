// Part of the module of occupancy/occupancy_trace.glsl: many rays from brick to brick.
//
// An invocation walks with two rays at a time, and what ends gives way to the next ray every other step. A step is a chain
// of operations that wait for each other; two of them fill a CPU's pipelines: in one run a single ray in each lane took 1.45 to
// 1.6 times as long.

struct M(Walk) {
    M(Line) line;
    ivec3 at;
    uint ray; // its bit; 0: none
    int steps; // that are left
};

void M(advance)(inout M(Walk) walk, inout uint hits) {
    bool found;
    ivec3 onward;
    float leave = M(brickStep)(walk.line, walk.at, found, onward);
    bool ends = found || leave > walk.line.to || (onward.x | onward.y | onward.z) >= RESOLUTION || !walk.line.intersects;
    --walk.steps;
#ifdef COUNT_EXHAUSTED
    if (walk.ray != 0u && !ends && walk.steps == 0) atomicAdd(M(exhausted)[1], 1u);
#endif
    hits |= found && walk.line.intersects ? walk.ray : 0u;
    walk.ray = ends || walk.steps == 0 ? 0u : walk.ray;
    walk.at = ends ? walk.at : onward;
}

// Of rays that are had by number (up to 32, those of `wanted`), which meet something.
uint M(anyHits)(uint wanted) {
    M(Walk) one, other;
    one.ray = 0u;
    other.ray = 0u;
    one.at = ivec3(0);
    other.at = ivec3(0);
    uint hits = 0u;
    while ((wanted | one.ray | other.ray) != 0u) {
        ITERATION;
        uint next = wanted & (~wanted + 1u);
        M(Line) line = M(line)(M(ray)(uint(max(findLSB(next), 0))));
        M(Walk) fresh = M(Walk)(line, min(ivec3(line.origin), ivec3(RESOLUTION - 1)), next, ITERATIONS);
        bool first = one.ray == 0u && next != 0u;
        bool second = other.ray == 0u && next != 0u && !first;
        if (first) one = fresh;
        if (second) other = fresh;
        if (first || second) {
            wanted ^= next;
#ifdef COUNT_EXHAUSTED
            atomicAdd(M(exhausted)[0], 1u);
#endif
        }
        for (int i = 0; i < 2; ++i) {
            ITERATION;
            M(advance)(one, hits);
            M(advance)(other, hits);
        }
    }
    return hits;
}
