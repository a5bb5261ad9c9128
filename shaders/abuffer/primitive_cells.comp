// From how many records each bucket has to where they begin: SUM adds up runs of pixels, SCAN (one invocation) says how
// many lie before each run, PLACE where the records of each bucket begin. A bucket's own count stands where the next
// one begins and becomes the place where its records begin, from which the records are counted on to its end as they
// come.
#include "lib/iterations.glsl"
#include "abuffer/primitive_lists.glsl"

layout(local_size_x = LOCAL_SIZE) in;

layout(r32ui) uniform uimageBuffer record_runs;
#ifdef SCAN
layout(std430) buffer RecordCount { uint record_count; };
#else
layout(r32ui) uniform uimageBuffer cells;
#endif
#ifdef PLACE
layout(std430) buffer LongestList { uint longest_list; };
#endif

void main() {
#ifdef SCAN
    uint sum = 0u;
    for (int i = 0; i < RUNS; ++i) {
        ITERATION;
        uint count = imageLoad(record_runs, i).r;
        imageStore(record_runs, i, uvec4(sum));
        sum += count;
    }
    record_count = sum;
#else
    int run = int(gl_GlobalInvocationID.x);
    int begin = run * RUN;
    int end = min(begin + RUN, PIXELS_IN_ALL);
    if (begin >= end) return;
#ifdef PLACE
    uint sum = imageLoad(record_runs, run).r;
#else
    uint sum = 0u;
#endif
    for (int pixel = begin; pixel < end; ++pixel) {
        ITERATION;
#ifdef PLACE
        uint first = sum;
        imageStore(cells, PRIMITIVE_BEGIN(pixel, 0), uvec4(sum));
        // Bounds between which nothing lies where there is no record.
        uint zMin = ~imageLoad(cells, pixel * PRIMITIVE_WORDS).r;
        bool empty = zMin == 0xffffffffu;
        imageStore(cells, pixel * PRIMITIVE_WORDS, uvec4(empty ? floatBitsToUint(3.0e38) : zMin));
#endif
        for (int bucket = 1; bucket <= BUCKETS; ++bucket) {
            ITERATION;
            uint count = imageLoad(cells, PRIMITIVE_BEGIN(pixel, bucket)).r;
#ifdef PLACE
            imageStore(cells, PRIMITIVE_BEGIN(pixel, bucket), uvec4(sum));
#endif
            sum += count;
        }
#ifdef PLACE
        atomicMax(longest_list, sum - first);
#endif
    }
#ifdef SUM
    imageStore(record_runs, run, uvec4(sum));
#endif
#endif
    ITERATIONS_END;
}
