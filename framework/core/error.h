// Errors. Three kinds, never mixed:
//   - a failed check (check.h) is a bug of ours and stops the program with both values;
//   - an Error is something outside the program's control (input, shader, file, machine) and carries a
//   location;
//   - an expected absence is a return value.
#pragma once
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kestrel {

// Process exit status; scripts rely on these numbers.
enum class ExitStatus : int {
    Done = 0,          // everything was done
    MeasureFailed = 1, // a measured check failed (compare --max, stress)
    BadInput = 2,      // bad input or usage
    MachineLacks = 3,  // the machine lacks something that is named
};

// A place in a text. `line` and `column` count from 1; 0 means "unknown" and is not printed.
struct Location {
    std::string file;
    int line = 0;
    int column = 0;
    // "file:line:column" without the unknown parts; empty if nothing is known.
    [[nodiscard]] std::string text() const;
    friend bool operator==(const Location&, const Location&) = default;
};

// One thing that is wrong with an input, and where.
struct Problem {
    Location where;
    std::string message; // one sentence, no full stop, no line break
    // "file:line:column: message".
    [[nodiscard]] std::string text() const;
};

// Base of all exceptions that Kestrel throws. what() is one line per problem.
class Error : public std::runtime_error {
public:
    Error(ExitStatus status, std::vector<Problem> problems);
    [[nodiscard]] ExitStatus status() const { return status_; }
    [[nodiscard]] const std::vector<Problem>& problems() const { return problems_; }

private:
    ExitStatus status_;
    std::vector<Problem> problems_;
};

// Something that the user gave is wrong (exit 2). Readers collect every problem before they throw.
class InputError : public Error {
public:
    explicit InputError(std::vector<Problem> problems)
        : Error(ExitStatus::BadInput, std::move(problems)) {}
    InputError(Location where, std::string message)
        : InputError({Problem{std::move(where), std::move(message)}}) {}
    explicit InputError(std::string message)
        : InputError(Location{}, std::move(message)) {}
};

// The machine lacks something (exit 3): no GL, no such extension, no such package built in.
class MachineError : public Error {
public:
    explicit MachineError(std::vector<Problem> problems)
        : Error(ExitStatus::MachineLacks, std::move(problems)) {}
    explicit MachineError(std::string message)
        : MachineError({Problem{{}, std::move(message)}}) {}
};

// The candidate nearest to `name` by edit distance, or empty if none is near enough to be a likely typing
// error (distance at most a third of the longer length, at least 1).
std::string nearName(std::string_view name, const std::vector<std::string>& candidates);

// " (did you mean 'X'?)" or empty: the tail of a message about an unknown name.
std::string didYouMean(std::string_view name, const std::vector<std::string>& candidates);

} // namespace kestrel
