// Checks of our own reasoning. A failed check is a bug: it prints both expressions, both values and the
// command that replays the run, then aborts. Never use a check for input (see error.h).
#pragma once
#include <fmt/format.h>
#include <string>

namespace kestrel {

// The command line that reproduces the present run; printed when a check fails. Set once by main().
void setReplayCommand(std::string command);

namespace detail {
[[noreturn]] void checkFailed(const char* file, int line, const char* expression, const std::string& values);

template<class T>
std::string checkedValue(const T& value) {
    if constexpr (fmt::is_formattable<T>::value) {
        return fmt::format("{}", value);
    } else {
        return "(not printable)";
    }
}

template<class A, class B>
std::string checkedValues(const char* a, const A& va, const char* b, const B& vb) {
    return fmt::format("{} = {}, {} = {}", a, checkedValue(va), b, checkedValue(vb));
}
} // namespace detail
} // namespace kestrel

#define KESTREL_CHECK(condition)                                                                             \
    do {                                                                                                     \
        if (!(condition)) ::kestrel::detail::checkFailed(__FILE__, __LINE__, #condition, {});                \
    } while (false)
#define KESTREL_CHECK_COMPARED(a, op, b)                                                                     \
    do {                                                                                                     \
        const auto& checkedA = (a);                                                                          \
        const auto& checkedB = (b);                                                                          \
        if (!(checkedA op checkedB))                                                                         \
            ::kestrel::detail::checkFailed(__FILE__, __LINE__, #a " " #op " " #b,                            \
                                           ::kestrel::detail::checkedValues(#a, checkedA, #b, checkedB));    \
    } while (false)
#define KESTREL_CHECK_EQ(a, b) KESTREL_CHECK_COMPARED(a, ==, b)
#define KESTREL_CHECK_NE(a, b) KESTREL_CHECK_COMPARED(a, !=, b)
#define KESTREL_CHECK_LT(a, b) KESTREL_CHECK_COMPARED(a, <, b)
#define KESTREL_CHECK_LE(a, b) KESTREL_CHECK_COMPARED(a, <=, b)
