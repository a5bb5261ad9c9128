// The loop guard. Some drivers give an invocation 65,535 iterations of all its loops together, those of functions that it calls
// among them, and then run the body of each further loop once, without an error (llvmpipe, Mesa 22.3.6); no invocation may
// make more than 65,000. Shaders whose bounds depend on data count their iterations where that is asked for
// (RenderOptions::countIterations); elsewhere these macros are nothing.
//
//     void main() {
//         while (...) {                 // in main and in whatever it calls (a tracer's functions, say):
//             ITERATION;                // first in the body of each loop, in whatever file it stands
//             for (...) { ITERATION; ... }
//         }
//         ITERATIONS_END;               // once, where main ends
//     }
//
// What is counted is one invocation's iterations; a driver that runs several in step counts every iteration that any of them
// makes, so leave some room. What may take more goes into several dispatches.
//
// `exhausted` is how many invocations exceeded the limit, `maximum` the most iterations of one. The block's name is reserved:
// the executor binds it, clears it and reads it (framework/shader/iterations.h).
#ifdef KESTREL_COUNT_ITERATIONS

layout(std430) buffer Iterations {
    uint exhausted;
    uint maximum;
} iterations;

const uint iterationsLimit = 65000u;
uint iterationsCount = 0u;

void iterationsRecord() { atomicMax(iterations.maximum, iterationsCount); }

void iterationsCountOne() {
    ++iterationsCount;
    // Recorded here too: the driver may end the invocation's loops before ITERATIONS_END.
    if (iterationsCount == iterationsLimit + 1u) {
        atomicAdd(iterations.exhausted, 1u);
        atomicMax(iterations.maximum, iterationsCount);
    }
}

#define ITERATION iterationsCountOne()
#define ITERATIONS_END iterationsRecord()

#else

#define ITERATION
#define ITERATIONS_END

#endif
