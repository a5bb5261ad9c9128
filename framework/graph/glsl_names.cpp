#include "graph/glsl_names.h"
#include <cctype>

namespace kestrel {

std::string blockName(std::string_view port) {
    std::string name;
    bool capital = true;
    for (const char letter : port) {
        if (letter == '_') {
            capital = true;
            continue;
        }
        name += capital ? static_cast<char>(std::toupper(static_cast<unsigned char>(letter))) : letter;
        capital = false;
    }
    return name;
}

std::string glslName(const std::string& path, const Use& use, ResourceKind kind, bool readBeside) {
    switch (use.access) {
    case Access::Fetch:
    case Access::Image:
        return path + (use.previous ? "previous_" : "") + use.port + (readBeside ? "_out" : "");
    case Access::Storage:
    case Access::Uniform:
        return path + (use.previous ? "Previous" : "") + blockName(use.port);
    case Access::Attachment:
        return kind == ResourceKind::Buffer ? std::string() : "out_" + use.port;
    case Access::Vertex:
    case Access::Indirect:
    case Access::Copy:
    case Access::Host:
        break;
    }
    return {};
}

std::string viewBlockName(const std::string& path, std::string_view port, bool previous) {
    return path + (previous ? "Previous" : "") + blockName(port) + "View";
}

} // namespace kestrel
