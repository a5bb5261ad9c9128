// Calls into code that is not ours (plugins): nothing but an Error comes out, and it names pass and call.
#pragma once
#include "core/error.h"
#include <exception>
#include <string>
#include <string_view>

namespace kestrel {

// "pass 'ao' failed in declare: REASON"
[[noreturn]] inline void failGuarded(std::string_view passName, std::string_view what, const char* reason) {
    std::string message = "pass '";
    message.append(passName).append("' failed in ").append(what).append(": ").append(reason);
    throw InputError(message);
}

// Runs `call` (which is `what` of pass `passName`). An Error passes as it is: it carries its own location;
// every other exception becomes an InputError.
template<class Call>
decltype(auto) guarded(std::string_view passName, std::string_view what, Call&& call) {
    try {
        return std::forward<Call>(call)();
    } catch (const Error&) {
        throw;
    } catch (const std::exception& foreign) {
        failGuarded(passName, what, foreign.what());
    } catch (...) {
        failGuarded(passName, what, "an exception of unknown kind");
    }
}

} // namespace kestrel
