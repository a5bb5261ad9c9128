// Where a command tells about its work, besides the results that are its purpose.
#pragma once
#include <cstdio>
#include <fmt/format.h>
#include <utility>

namespace kestrel {

// Standard output, but standard error where results go to standard output, and nowhere (null) under --quiet,
// with which only errors are told, and what was asked for as data.
inline std::FILE*& reportStream() {
    static std::FILE* stream = stdout;
    return stream;
}

template<class... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
    if (reportStream() != nullptr) fmt::print(reportStream(), format, std::forward<Args>(args)...);
}

} // namespace kestrel
