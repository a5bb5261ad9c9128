#include "freed_memory.h"
#include <limits>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace kestrel {

void keepFreedMemory() {
#ifdef __GLIBC__
    mallopt(M_MMAP_THRESHOLD, 32 << 20); // the most that it takes: blocks of more are mapped each for itself
    mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
#endif
}

} // namespace kestrel
