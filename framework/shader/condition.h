// The preprocessor's conditionals as far as they can be judged before compiling: three-valued, since a macro
// that an extension or an undecided branch defines is neither defined nor undefined here.
#pragma once
#include "shader/lines.h"
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace kestrel {

enum class Truth { No, Yes, Unknown };
Truth operator!(Truth a);
Truth operator&&(Truth a, Truth b);
Truth operator||(Truth a, Truth b);

// What is known of a macro at some point of a text. `text` counts only where it is surely defined.
struct MacroState {
    Truth defined = Truth::No;
    std::string text;
};
using MacroLookup = std::function<MacroState(std::string_view name)>;

// The value of an `#if` expression: C's integer expressions with `defined`. A name that is not defined is 0.
// Unknown if a macro that matters is unknown or not a plain integer, or if the text is no such expression.
Truth evaluateCondition(std::string_view expression, const MacroLookup& lookup);

// The conditionals of one file that are open at the present line.
class ConditionalStack {
public:
    enum class Result { NotConditional, Done, WithoutIf, AfterElse };
    // Takes a directive of the file; #if, #ifdef, #ifndef, #elif, #else and #endif are Done unless out of
    // place.
    Result take(const Directive& directive, int line, const MacroLookup& lookup);
    // Whether the present line is compiled, as far as this file's conditionals say.
    [[nodiscard]] Truth active() const;
    // Whether the present line stands in a branch that only C++ takes.
    [[nodiscard]] bool onlyForCpp() const;
    [[nodiscard]] bool open() const { return !frames_.empty(); }
    // The line of the innermost open #if.
    [[nodiscard]] int line() const { return frames_.back().line; }

private:
    struct Frame {
        Truth branch = Truth::No; // of the present branch
        Truth taken = Truth::No;  // whether any branch so far was
        bool cpp = false;         // the conditional asks for __cplusplus
        bool sawElse = false;
        int line = 0;
    };
    std::vector<Frame> frames_;
};

} // namespace kestrel
