#include "reference/rows.h"
#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace kestrel {

void forEachRow(int height, int threads, const std::function<void(int)>& row, const Progress& progress) {
    std::atomic<int> next = 0;
    std::mutex mutex;
    std::exception_ptr failure;
    int done = 0;
    const auto work = [&] {
        for (int y = next++; y < height; y = next++) {
            try {
                row(y);
                if (!progress) continue;
                const std::lock_guard lock(mutex);
                progress(static_cast<double>(++done) / height);
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!failure) failure = std::current_exception();
                next = height;
            }
        }
    };
    std::vector<std::jthread> others;
    for (int i = 1; i < std::clamp(threads, 1, std::max(1, height)); ++i) others.emplace_back(work);
    work();
    others.clear(); // joins
    if (failure) std::rethrow_exception(failure);
}

} // namespace kestrel
