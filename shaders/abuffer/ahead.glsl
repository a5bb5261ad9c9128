// Part of the modules of an A-buffer: over pixels in which a ray meets nothing. They say where they look: LOOKS_AHEAD, what a
// pixel has (boundsOf), and the depths that the ray has ahead, widened by what either may be off (depthsAhead).

const ABufferSteps M(steps) = ABufferSteps(LEVELS, SAMPLES);

void M(countRay)(bool exhausted) {
#ifdef COUNT_EXHAUSTED
    atomicAdd(M(exhausted)[0], 1u);
    if (exhausted) atomicAdd(M(exhausted)[1], 1u);
#endif
}

// To the next pixel that has something where the ray is; false if the view is left before. A loop of its own, and
// nothing but the bounds in it: on a driver that runs both sides of every branch a loop is all that can be left early.
bool M(goesOn)(inout ABufferMarch march) {
    while (march.inside) {
        ITERATION;
        ++M(spent);
        abufferAhead(march, M(steps));
#ifdef LOOKS_AHEAD
        vec2 depths = M(depthsAhead)(march);
#if LEVELS > 1
        int block = 2 * abufferBlock(march, ABUFFER_SHAPE, MAIN_SIZE);
        vec2 bounds = uintBitsToFloat(
            uvec2(imageLoad(M(block_bounds), block).r, imageLoad(M(block_bounds), block + 1).r));
#else
        vec2 bounds = M(boundsOf)(ABUFFER_PIXEL(march.view, march.pixel));
#endif
        bool skips = bounds.y < depths.x || bounds.x > depths.y;
        if (!skips && march.level == 0) break;
        if (M(spent) > uint(BUDGET)) break;
        if (skips) {
            abufferCross(march, M(steps));
        } else {
            --march.level;
        }
#else
        break;
#endif
    }
    return march.inside;
}
