#include "shader/names.h"
#include "shader/lines.h"
#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace kestrel {
namespace {

constexpr std::array<std::string_view, 4> predefinedNames{"__LINE__", "__FILE__", "__VERSION__",
                                                          "__cplusplus"};

bool isReserved(std::string_view name) {
    if (name.find("__") == std::string_view::npos) return false;
    return std::find(predefinedNames.begin(), predefinedNames.end(), name) == predefinedNames.end();
}

// Whether `rest` is what follows the M of `M(_...)`.
bool prefixesAnUnderscore(std::string_view rest) {
    rest = trimmed(rest);
    return rest.starts_with('(') && trimmed(rest.substr(1)).starts_with('_');
}

} // namespace

std::string whyNotAName(std::string_view name) {
    if (!isIdentifier(name)) return "is no GLSL name (letters, digits, underscores)";
    if (name.find("__") != std::string_view::npos) return "has a double underscore, which GLSL reserves";
    if (name.front() == '_' || name.back() == '_')
        return "begins or ends with an underscore, which would make a double one";
    if (name.starts_with("gl_") || name.starts_with("GL_")) return "begins with gl_, which GLSL reserves";
    if (name == "M" || name == "defined") return "is reserved for composition";
    return {};
}

std::vector<std::string> nameProblems(std::string_view code) {
    std::vector<std::string> problems;
    for (const std::string_view name : identifiersOf(code)) {
        if (isReserved(name))
            problems.push_back(fmt::format("'{}' has a double underscore, which GLSL reserves", name));
        const auto end = static_cast<size_t>(name.data() + name.size() - code.data());
        if (name == "M" && prefixesAnUnderscore(code.substr(end)))
            problems.emplace_back("M(_...) would make a name with a double underscore, which GLSL reserves");
    }
    return problems;
}

} // namespace kestrel
