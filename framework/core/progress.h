// A progress line on standard error, where that is a terminal; elsewhere, and where only errors are
// logged, nothing is printed.
#pragma once
#include <chrono>
#include <string>

namespace kestrel {

class ProgressBar {
public:
    explicit ProgressBar(std::string what);
    ~ProgressBar(); // takes the line away
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    // `fraction` from 0 to 1. Shown once the work has taken a second, and then ten times a second at most.
    void update(double fraction, const std::string& detail = {});
    void clear();

private:
    using Clock = std::chrono::steady_clock;
    std::string what_;
    Clock::time_point begin_ = Clock::now(), shown_ = begin_;
    bool visible_ = false;
};

// The line itself: "render [#####.....]  50 %  frame 3 of 6, 4 s left".
std::string progressLine(const std::string& what, double fraction, double seconds, const std::string& detail);

} // namespace kestrel
