#include "core/progress.h"
#include "core/log.h"
#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <unistd.h>

namespace kestrel {

std::string progressLine(const std::string& what, double fraction, double seconds,
                         const std::string& detail) {
    constexpr int width = 30;
    fraction = std::clamp(fraction, 0.0, 1.0);
    const int done = static_cast<int>(fraction * width);
    std::string line =
        fmt::format("{} [{:#<{}}{:.<{}}] {:3.0f} %", what, "", done, "", width - done, 100 * fraction);
    if (!detail.empty()) line += "  " + detail;
    if (fraction > 0 && fraction < 1)
        line += fmt::format(", {:.0f} s left", seconds / fraction * (1 - fraction));
    return line;
}

ProgressBar::ProgressBar(std::string what)
    : what_(std::move(what)) {}

ProgressBar::~ProgressBar() { clear(); }

void ProgressBar::update(double fraction, const std::string& detail) {
    static const bool terminal = isatty(STDERR_FILENO) != 0;
    if (!terminal || logLevel() >= LogLevel::Error) return;
    const auto now = Clock::now();
    const std::chrono::duration<double> elapsed = now - begin_, sinceShown = now - shown_;
    if (elapsed.count() < 1 || sinceShown.count() < 0.1) return;
    shown_ = now;
    visible_ = true;
    fmt::print(stderr, "\r\033[K{}", progressLine(what_, fraction, elapsed.count(), detail));
    std::fflush(stderr);
}

void ProgressBar::clear() {
    if (!visible_) return;
    fmt::print(stderr, "\r\033[K");
    std::fflush(stderr);
    visible_ = false;
}

} // namespace kestrel
