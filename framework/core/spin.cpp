#include "core/spin.h"
#include "core/check.h"
#include <chrono>
#include <cstdint>
#include <thread>

namespace kestrel {
namespace {

// A chain of dependent integer operations: neither memory nor vector units play a part.
std::uint64_t work() {
    constexpr int steps = 12'000'000;
    std::uint64_t state = 1;
    for (int i = 0; i < steps; ++i) {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
    }
    return state;
}

double milliseconds(std::chrono::steady_clock::time_point from) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - from).count();
}

} // namespace

SpinTest measureSpin() {
    SpinTest result;
    auto start = std::chrono::steady_clock::now();
    const std::uint64_t alone = work();
    result.oneThreadMs = milliseconds(start);
    start = std::chrono::steady_clock::now();
    std::uint64_t otherWork = 0;
    std::thread other([&otherWork] { otherWork = work(); });
    const std::uint64_t together = work();
    other.join();
    result.twoThreadsMs = milliseconds(start);
    // Read, or the compiler drops the work.
    KESTREL_CHECK_EQ(alone, together);
    KESTREL_CHECK_EQ(alone, otherWork);
    return result;
}

} // namespace kestrel
