// Where the records of primitives lie. A pixel has PRIMITIVE_WORDS words in `cells` (r32ui): the least and largest
// depth of its records, and where the records of each of its BUCKETS buckets begin, and after them where the last ends.
// A record is a texel of `records` (rgba32ui): least and largest depth in the pixel, triangle, and the bucket that the
// least depth lies in; those of a bucket lie in order of depth, then of triangle. A primitive has a record in every
// bucket that its interval meets.
#include "shared/abuffer.h"

// Macros, so that a module's own defines hold in them, whoever included this file first.
#define PRIMITIVE_WORDS (BUCKETS + 3)
#define PRIMITIVE_BEGIN(pixel, bucket) (int(pixel) * PRIMITIVE_WORDS + 2 + int(bucket))
