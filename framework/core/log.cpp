#include "core/log.h"
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace kestrel {
namespace {

spdlog::level::level_enum toSpdlog(LogLevel level) {
    switch (level) {
    case LogLevel::Debug:
        return spdlog::level::debug;
    case LogLevel::Info:
        return spdlog::level::info;
    case LogLevel::Warning:
        return spdlog::level::warn;
    case LogLevel::Error:
        return spdlog::level::err;
    case LogLevel::Off:
        break;
    }
    return spdlog::level::off;
}

spdlog::logger& logger() {
    // No time in the pattern: two runs of one command print the same text.
    static const auto instance = [] {
        auto made = std::make_shared<spdlog::logger>("kestrel",
                                                     std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
        made->set_pattern("%^%l%$: %v");
        made->set_level(spdlog::level::warn);
        return made;
    }();
    return *instance;
}

} // namespace

void setLogLevel(LogLevel level) { logger().set_level(toSpdlog(level)); }
LogLevel logLevel() {
    for (const LogLevel level : {LogLevel::Debug, LogLevel::Info, LogLevel::Warning, LogLevel::Error})
        if (logger().should_log(toSpdlog(level))) return level;
    return LogLevel::Off;
}

void logMessage(LogLevel level, const std::string& message) { logger().log(toSpdlog(level), message); }

} // namespace kestrel
