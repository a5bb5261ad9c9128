// Collecting the mistakes of an input, within bounds: a file of a thousand mistakes is of another kind than
// the reader.
#pragma once
#include "core/error.h"
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace kestrel {

// So many mistakes of one input are told.
inline constexpr std::size_t maxProblems = 1'000;

// Notes one more mistake; the one that is too many throws InputError with all that were noted, and says so.
inline void noteProblem(std::vector<Problem>& problems, const Location& where, std::string message) {
    if (problems.size() >= maxProblems) {
        problems.push_back(
            {where, "has more than " + std::to_string(maxProblems) + " mistakes; these are the first"});
        throw InputError(std::move(problems));
    }
    problems.push_back({where, std::move(message)});
}

} // namespace kestrel
