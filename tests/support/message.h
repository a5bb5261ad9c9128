// What an error says.
#pragma once
#include "core/error.h"
#include <string>

namespace kestrel::test {

// The message of the Error that `action` throws; "no error" if it throws none.
template<class Error = InputError, class Action>
std::string messageOf(const Action& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

} // namespace kestrel::test
