// Splits the rows of an image among threads.
#pragma once
#include <functional>

namespace kestrel {

// Told now and then how much is done, from 0 to 1, rising; never from two threads at once.
using Progress = std::function<void(double)>;

// Calls `row` once for each of 0 to `height` - 1, from `threads` threads (at least 1) at once. What rows do
// must not depend on each other; the first exception ends the work and is thrown here.
void forEachRow(int height, int threads, const std::function<void(int)>& row, const Progress& progress = {});

} // namespace kestrel
