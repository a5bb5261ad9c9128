// Times the steps of a frame on the GPU.
#pragma once
#include "gl/objects.h"
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace kestrel::gl {

void deleteQuery(Name name);

// On a CPU renderer timer queries do not measure the work (a 15 ms dispatch reads 0.08), so a step is wall
// clock between two glFinish; on a GPU it is a pair of timestamps, read one frame later so that nothing
// waits. Every report states which by name().
class StepClock {
public:
    enum class Kind : std::uint8_t { Finish, TimerQuery };

    explicit StepClock(const Capabilities& capabilities)
        : StepClock(capabilities.software ? Kind::Finish : Kind::TimerQuery) {}
    explicit StepClock(Kind kind)
        : kind_(kind) {}

    // "finish", "timer_query"; InputError with the near name otherwise.
    static Kind kindFromName(const std::string& name);

    [[nodiscard]] Kind kind() const { return kind_; }
    [[nodiscard]] std::string_view name() const { return kind_ == Kind::Finish ? "finish" : "timer query"; }

    struct Sample {
        std::uint64_t frame = 0; // as given to beginFrame
        std::uint32_t step = 0;  // as given to begin
        double ms = 0;
    };

    void beginFrame(std::uint64_t frame);
    // Steps do not nest.
    void begin(std::uint32_t step);
    void end();
    // The samples that have become known since the last call, in order. With timer queries these are of
    // frames before the present one; `wait` brings the present one's too.
    std::vector<Sample> take(bool wait = false);

private:
    struct Pending {
        Sample sample;
        Handle<deleteQuery> first, second;
    };
    Handle<deleteQuery> query();
    void collect(bool wait);

    Kind kind_;
    std::uint64_t frame_ = 0;
    Sample open_;
    bool isOpen_ = false;
    std::chrono::steady_clock::time_point start_;
    Handle<deleteQuery> startQuery_;
    std::vector<Pending> pending_;
    std::vector<Handle<deleteQuery>> spare_;
    std::vector<Sample> known_;
};

} // namespace kestrel::gl
