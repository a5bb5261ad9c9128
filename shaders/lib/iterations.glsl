// The loop guard. Some drivers stop a loop nest (an outermost loop with all loops inside it, also those of functions
// that it calls) silently after 65,535 iterations; no nest may make more than 65,000. Shaders whose bounds depend on data
// count their iterations where that is asked for (RenderOptions::countIterations); elsewhere these macros are nothing.
//
//     void main() {
//         ITERATIONS_BEGIN;             // before each outermost loop, and before each call outside a loop of a
//         while (...) {                 // function that loops (a tracer's, say)
//             ITERATION;                // first in the body of each loop, in whatever file it stands
//             for (...) { ITERATION; ... }
//         }
//         ITERATIONS_END;               // once, where main ends
//     }
//
// A library or module function writes ITERATION only: it cannot know whether its caller loops. An ITERATIONS_BEGIN too few makes
// sequential nests count as one: a false alarm, never a missed one. What is counted is one invocation's iterations; a driver
// that runs several in step counts every iteration that any of them makes, so leave a nest some room.
//
// `exhausted` is how many nests exceeded the limit, `maximum` the most iterations of a nest. The block's name is reserved:
// the executor binds it, clears it and reads it (framework/shader/iterations.h).
#ifdef KESTREL_COUNT_ITERATIONS

layout(std430) buffer Iterations {
    uint exhausted;
    uint maximum;
} iterations;

const uint iterationsLimit = 65000u;
uint iterationsCount = 0u;

void iterationsRecord() {
    if (iterationsCount > 0u) atomicMax(iterations.maximum, iterationsCount);
    iterationsCount = 0u;
}

void iterationsCountOne() {
    ++iterationsCount;
    // Recorded here too: the driver may end the invocation's loop before ITERATIONS_END.
    if (iterationsCount == iterationsLimit + 1u) {
        atomicAdd(iterations.exhausted, 1u);
        atomicMax(iterations.maximum, iterationsCount);
    }
}

#define ITERATIONS_BEGIN iterationsRecord()
#define ITERATION iterationsCountOne()
#define ITERATIONS_END iterationsRecord()

#else

#define ITERATIONS_BEGIN
#define ITERATION
#define ITERATIONS_END

#endif
