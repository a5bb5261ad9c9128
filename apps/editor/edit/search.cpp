#include "edit/search.h"
#include "edit/properties.h"
#include "graph/value_text.h"
#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <sstream>

namespace kestrel::edit {
namespace {

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

bool occurs(const std::string& part, const std::string& text) {
    return lower(text).find(part) != std::string::npos;
}

std::string plainText(const Value& value) {
    const auto* text = std::get_if<std::string>(&value);
    return text != nullptr ? *text : jsonText(value);
}

// One part of a query against one pass: why it matches, empty if it does not.
class Matcher {
public:
    Matcher(const Graph& graph, const GraphPass& pass, const PassType* type)
        : graph_(graph)
        , pass_(pass)
        , type_(type) {}

    [[nodiscard]] std::string text(const std::string& part) const {
        if (const size_t equals = part.find('='); equals != std::string::npos && equals > 0)
            return property(part.substr(0, equals), part.substr(equals + 1));
        if (occurs(part, pass_.name)) return "name";
        if (occurs(part, pass_.type)) return "type " + pass_.type;
        if (part == "muted" && pass_.muted) return "muted";
        if (type_ != nullptr)
            for (const PortInfo& port : type_->ports)
                if (occurs(part, port.name)) return "port " + port.name;
        if (const std::string found = property(part, {}); !found.empty()) return found;
        for (const auto& [name, value] : pass_.properties)
            if (occurs(part, plainText(value))) return fmt::format("{} = {}", name, plainText(value));
        return occurs(part, pass_.comment) ? "comment" : "";
    }

    [[nodiscard]] std::string reads(const std::string& part) const {
        for (const GraphEdge& edge : graph_.edges)
            if (edge.to.pass == pass_.name && (occurs(part, edge.from.text()) || occurs(part, edge.to.port)))
                return "reads " + edge.from.text();
        return ownPort(part, PortDirection::Input, "reads ");
    }

    [[nodiscard]] std::string writes(const std::string& part) const {
        for (const GraphEdge& edge : graph_.edges)
            if (edge.from.pass == pass_.name &&
                (occurs(part, edge.to.text()) || occurs(part, edge.from.port)))
                return "writes " + edge.to.text();
        return ownPort(part, PortDirection::Output, "writes ");
    }

private:
    [[nodiscard]] std::string ownPort(const std::string& part, PortDirection direction,
                                      const char* verb) const {
        if (type_ != nullptr)
            for (const std::string& port : type_->portNames(direction))
                if (occurs(part, port)) return verb + port;
        return {};
    }

    // By name, and if a value is given by the value that it has, the default included.
    [[nodiscard]] std::string property(const std::string& name, const std::string& value) const {
        if (type_ == nullptr) return {};
        for (const PropertyInfo& info : type_->properties) {
            if (!occurs(name, info.name)) continue;
            const std::string held = plainText(propertyValue(pass_, info));
            if (value.empty() || lower(held) == value) return fmt::format("{} = {}", info.name, held);
        }
        return {};
    }

    const Graph& graph_;
    const GraphPass& pass_;
    const PassType* type_;
};

} // namespace

std::vector<Found> search(const Graph& graph, const Registry& registry, const std::string& query) {
    std::vector<std::string> parts;
    std::istringstream words(lower(query));
    for (std::string word; words >> word;) {
        std::string next;
        if ((word == "reads" || word == "writes") && words >> next) word += " " + next;
        parts.push_back(word);
    }
    std::vector<Found> found;
    if (parts.empty()) return found;
    for (const GraphPass& pass : graph.passes) {
        const Matcher matcher(graph, pass, registry.find(pass.type));
        std::string why;
        bool all = true;
        for (const std::string& part : parts) {
            const std::string reason = part.starts_with("reads ")    ? matcher.reads(part.substr(6))
                                       : part.starts_with("writes ") ? matcher.writes(part.substr(7))
                                                                     : matcher.text(part);
            all = all && !reason.empty();
            why += (why.empty() ? "" : ", ") + reason;
        }
        if (all) found.push_back({pass.name, why});
    }
    return found;
}

int matchRank(const std::string& text, const std::string& part) {
    const std::string where = lower(text), what = lower(part);
    if (const size_t at = where.find(what); at != std::string::npos) return static_cast<int>(at);
    // Letters in their order; first letters of words count as near.
    int gaps = 0;
    size_t at = 0;
    for (const char letter : what) {
        const size_t next = where.find(letter, at);
        if (next == std::string::npos) return -1;
        const bool begins =
            next == 0 || std::isupper(static_cast<unsigned char>(text[next])) != 0 || text[next - 1] == '_';
        if (!begins) gaps += static_cast<int>(next - at);
        at = next + 1;
    }
    return 1'000 + gaps;
}

} // namespace kestrel::edit
