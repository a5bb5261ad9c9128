// A shader text as the preprocessor sees it: logical lines (a line that ends in a backslash goes on in the
// next) with their comments blanked, directives, and identifiers.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kestrel {

// One logical line: `count` lines of the text from line `number` on (from 1).
struct ShaderLine {
    int number = 1;
    int count = 1;
    std::string_view raw; // as in the text, without the last line end; refers to the text
    std::string code;     // comments are blanks, and continued lines are joined
};

std::vector<ShaderLine> shaderLines(std::string_view text);

// A preprocessor line: "#  include  <a> " is {"include", "<a>"}.
struct Directive {
    std::string name;
    std::string rest; // trimmed
};
std::optional<Directive> directiveOf(std::string_view code);

// What an #include asks for: the module at a port (<port:NAME>), a part of the module itself (<part:PATH>) or
// a library file ("PATH"). Nothing for anything else.
struct IncludeTarget {
    enum Kind { Library, Port, Part } kind = Library;
    std::string name; // of the port, or the path
};
std::optional<IncludeTarget> includeTargetOf(std::string_view rest);

// The macro that a #define or #undef speaks of, and the text it stands for.
struct MacroLine {
    std::string name;
    bool takesArguments = false;
    std::string text;
};
std::optional<MacroLine> macroLineOf(const Directive& directive);

// The identifiers (also keywords) of a code line, in order.
std::vector<std::string_view> identifiersOf(std::string_view code);

bool isIdentifier(std::string_view text);
std::string_view trimmed(std::string_view text);

} // namespace kestrel
