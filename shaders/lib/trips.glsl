// The loop guard. Some drivers stop a loop nest (an outermost loop with all loops inside it, also those of functions
// that it calls) silently after 65,535 trips; no nest may make more than 65,000. Shaders whose bounds depend on data
// count their trips in a debug build; elsewhere these macros are nothing.
//
//     void main() {
//         TRIPS_BEGIN;                       // before each outermost loop, and before each call outside a loop of a
//         while (...) {                      // function that loops (a tracer's, say)
//             TRIP;                          // first in the body of each loop, in whatever file it stands
//             for (...) { TRIP; ... }
//         }
//         TRIPS_END;                         // once, where main ends
//     }
//
// A library or module function writes TRIP only: it cannot know whether its caller loops. A TRIPS_BEGIN too few makes
// sequential nests count as one: a false alarm, never a missed one. What is counted is one invocation's trips; a driver
// that runs several in step counts every trip that any of them makes, so leave a nest some room.
//
// `exhausted` is how many nests exceeded the limit, `maximum` the most trips of a nest. The block's name is reserved:
// the executor binds it, clears it and reads it (framework/shader/trips.h).
#ifdef KESTREL_DEBUG_TRIPS

layout(std430) buffer Trips {
    uint exhausted;
    uint maximum;
} trips;

const uint tripsLimit = 65000u;
uint tripsCount = 0u;

void tripsRecord() {
    if (tripsCount > 0u) atomicMax(trips.maximum, tripsCount);
    tripsCount = 0u;
}

void tripsCountOne() {
    ++tripsCount;
    // Recorded here too: the driver may end the invocation's loop before TRIPS_END.
    if (tripsCount == tripsLimit + 1u) {
        atomicAdd(trips.exhausted, 1u);
        atomicMax(trips.maximum, tripsCount);
    }
}

#define TRIPS_BEGIN tripsRecord()
#define TRIP tripsCountOne()
#define TRIPS_END tripsRecord()

#else

#define TRIPS_BEGIN
#define TRIP
#define TRIPS_END

#endif
