// The log: one line a message on standard error, so that standard output stays clean for results.
#pragma once
#include <fmt/format.h>
#include <string>
#include <utility>

namespace kestrel {

enum class LogLevel { Debug, Info, Warning, Error, Off };

void setLogLevel(LogLevel level);
[[nodiscard]] LogLevel logLevel();
void logMessage(LogLevel level, const std::string& message);

template<class... Args>
void logDebug(fmt::format_string<Args...> format, Args&&... args) {
    logMessage(LogLevel::Debug, fmt::format(format, std::forward<Args>(args)...));
}
template<class... Args>
void logInfo(fmt::format_string<Args...> format, Args&&... args) {
    logMessage(LogLevel::Info, fmt::format(format, std::forward<Args>(args)...));
}
template<class... Args>
void logWarning(fmt::format_string<Args...> format, Args&&... args) {
    logMessage(LogLevel::Warning, fmt::format(format, std::forward<Args>(args)...));
}
template<class... Args>
void logError(fmt::format_string<Args...> format, Args&&... args) {
    logMessage(LogLevel::Error, fmt::format(format, std::forward<Args>(args)...));
}

} // namespace kestrel
