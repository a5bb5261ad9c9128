#include "shader/lines.h"
#include <algorithm>

namespace kestrel {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

bool isNameStart(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool isDigit(char c) { return c >= '0' && c <= '9'; }
bool isNamePart(char c) { return isNameStart(c) || isDigit(c); }

// The physical lines that make one logical line: [begin, end) without the last line end.
size_t endOfLogicalLine(std::string_view text, size_t begin, int& count) {
    count = 1;
    size_t end = begin;
    for (;; ++count) {
        end = std::min(text.find('\n', end), text.size());
        if (end == text.size() || end == begin || text[end - 1] != '\\') return end;
        ++end;
        if (end == text.size()) return end;
    }
}

// Blanks comments; `inBlock` carries a block comment from line to line. A quoted file name may hold "//".
std::string withoutComments(std::string_view line, bool& inBlock) {
    std::string code;
    code.reserve(line.size());
    bool quoted = false;
    for (size_t i = 0; i < line.size(); ++i) {
        const std::string_view two = line.substr(i, 2);
        if (inBlock) {
            if (two == "*/") {
                inBlock = false;
                ++i;
                code += ' ';
            }
            continue;
        }
        if (two == "\\\n") {
            ++i;
            continue;
        }
        if (!quoted && two == "//") break;
        if (!quoted && two == "/*") {
            inBlock = true;
            ++i;
            continue;
        }
        if (line[i] == '"') quoted = !quoted;
        code += line[i];
    }
    return code;
}

} // namespace

std::vector<ShaderLine> shaderLines(std::string_view text) {
    std::vector<ShaderLine> lines;
    bool inBlock = false;
    int number = 1;
    for (size_t begin = 0; begin < text.size();) {
        ShaderLine line;
        line.number = number;
        const size_t end = endOfLogicalLine(text, begin, line.count);
        line.raw = text.substr(begin, end - begin);
        line.code = withoutComments(line.raw, inBlock);
        number += line.count;
        lines.push_back(std::move(line));
        begin = end + 1;
    }
    return lines;
}

std::string_view trimmed(std::string_view text) {
    const size_t begin = text.find_first_not_of(blanks);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

std::optional<Directive> directiveOf(std::string_view code) {
    std::string_view rest = trimmed(code);
    if (rest.empty() || rest.front() != '#') return std::nullopt;
    rest = trimmed(rest.substr(1));
    const auto nameEnd = std::find_if_not(rest.begin(), rest.end(), isNamePart);
    const auto length = static_cast<size_t>(nameEnd - rest.begin());
    return Directive{std::string(rest.substr(0, length)), std::string(trimmed(rest.substr(length)))};
}

std::vector<std::string_view> identifiersOf(std::string_view code) {
    std::vector<std::string_view> names;
    for (size_t i = 0; i < code.size();) {
        size_t end = i + 1;
        if (isNamePart(code[i])) {
            while (end < code.size() && isNamePart(code[end])) ++end;
            if (isNameStart(code[i])) names.push_back(code.substr(i, end - i));
        }
        i = end;
    }
    return names;
}

bool isIdentifier(std::string_view text) {
    return !text.empty() && isNameStart(text.front()) && std::all_of(text.begin(), text.end(), isNamePart);
}

std::optional<IncludeTarget> includeTargetOf(std::string_view rest) {
    const auto between = [rest](std::string_view opening) {
        return std::string(trimmed(rest.substr(opening.size(), rest.size() - opening.size() - 1)));
    };
    constexpr std::string_view port = "<port:", part = "<part:";
    if (rest.starts_with(port) && rest.ends_with('>'))
        return IncludeTarget{IncludeTarget::Port, between(port)};
    if (rest.starts_with(part) && rest.ends_with('>'))
        return IncludeTarget{IncludeTarget::Part, between(part)};
    if (rest.size() < 2 || rest.front() != '"' || rest.find('"', 1) != rest.size() - 1) return std::nullopt;
    return IncludeTarget{IncludeTarget::Library, std::string(rest.substr(1, rest.size() - 2))};
}

std::optional<MacroLine> macroLineOf(const Directive& directive) {
    const std::vector<std::string_view> names = identifiersOf(directive.rest);
    if (names.empty() || !directive.rest.starts_with(names.front())) return std::nullopt;
    const std::string_view rest = std::string_view(directive.rest).substr(names.front().size());
    return MacroLine{std::string(names.front()), rest.starts_with('('), std::string(trimmed(rest))};
}

} // namespace kestrel
