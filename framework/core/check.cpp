#include "core/check.h"
#include <cstdio>
#include <cstdlib>

namespace kestrel {
namespace {
std::string& replayCommand() {
    static std::string command;
    return command;
}
} // namespace

void setReplayCommand(std::string command) { replayCommand() = std::move(command); }

void detail::checkFailed(const char* file, int line, const char* expression, const std::string& values) {
    std::fprintf(stderr, "%s:%d: check failed: %s%s%s\n", file, line, expression, values.empty() ? "" : ": ",
                 values.c_str());
    if (!replayCommand().empty()) std::fprintf(stderr, "replay: %s\n", replayCommand().c_str());
    std::fflush(stderr);
    std::abort();
}

} // namespace kestrel
