// What is wrong with a graph against the table of pass types.
#include "core/problems.h"
#include "graph/graph.h"
#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <set>
#include <unordered_map>

namespace kestrel {
namespace {

class Validator {
public:
    Validator(const Graph& graph, const Registry& registry)
        : graph_(graph)
        , registry_(registry) {
        for (const GraphPass& pass : graph.passes) byName_.try_emplace(pass.name, &pass);
    }

    std::vector<Problem> run() {
        try {
            checkAll();
        } catch (const InputError& tooMany) {
            problems_ = tooMany.problems();
        }
        std::stable_sort(problems_.begin(), problems_.end(), [](const Problem& a, const Problem& b) {
            return std::pair(a.where.line, a.where.column) < std::pair(b.where.line, b.where.column);
        });
        return std::move(problems_);
    }

private:
    void checkAll() {
        for (const GraphPass& pass : graph_.passes) checkPass(pass);
        for (const GraphEdge& edge : graph_.edges) checkEdge(edge);
        checkRequiredInputs();
        checkCycles();
        std::map<PortRef, Location> seen;
        for (const GraphOutput& output : graph_.outputs) checkOutput(output, seen);
    }
    void note(const Location& where, std::string message) {
        noteProblem(problems_, where, std::move(message));
    }
    [[nodiscard]] const GraphPass* find(const std::string& name) const {
        const auto found = byName_.find(name);
        return found == byName_.end() ? nullptr : found->second;
    }
    [[nodiscard]] const PassType* typeOf(const GraphPass& pass) const { return registry_.find(pass.type); }

    // ---- passes and their properties
    void checkPass(const GraphPass& pass) {
        if (!isGraphName(pass.name))
            note(pass.where, fmt::format("the pass name '{}' must be lower_case letters, digits and single "
                                         "underscores, at most 64, and begin with a letter",
                                         pass.name));
        if (find(pass.name) != &pass) note(pass.where, fmt::format("pass '{}' stands twice", pass.name));
        const PassType* type = typeOf(pass);
        if (type == nullptr) {
            note(pass.where, fmt::format("pass '{}' has the unknown type '{}'{}", pass.name, pass.type,
                                         didYouMean(pass.type, registry_.names())));
            return;
        }
        for (const auto& [name, value] : pass.properties) checkProperty(pass, *type, name, value);
    }

    void checkProperty(const GraphPass& pass, const PassType& type, const std::string& name,
                       const Value& value) {
        const auto place = pass.propertyWhere.find(name);
        const Location& where = place == pass.propertyWhere.end() ? pass.where : place->second;
        const PropertyInfo* property = type.property(name);
        if (property == nullptr) {
            note(where, fmt::format("pass '{}' ({}) has no property '{}'{}", pass.name, type.name, name,
                                    didYouMean(name, type.propertyNames())));
        } else if (const auto mistake = valueMistake(*property, value)) {
            note(where, fmt::format("property '{}' of pass '{}' {}", name, pass.name, *mistake));
        }
    }

    // ---- ports
    // The port if pass, type and port exist and it has the wanted direction; notes what is wrong.
    const PortInfo* port(const PortRef& ref, PortDirection wanted, const Location& where) {
        const GraphPass* pass = find(ref.pass);
        if (pass == nullptr) {
            std::vector<std::string> names;
            for (const GraphPass& candidate : graph_.passes) names.push_back(candidate.name);
            note(where, fmt::format("there is no pass '{}' (in '{}'){}", ref.pass, ref.text(),
                                    didYouMean(ref.pass, names)));
            return nullptr;
        }
        const PassType* type = typeOf(*pass);
        if (type == nullptr) return nullptr; // noted where the pass stands
        const PortInfo* info = type->port(ref.port);
        const char* direction = wanted == PortDirection::Input ? "input" : "output";
        if (info == nullptr) {
            note(where, fmt::format("pass '{}' ({}) has no {} '{}'{}", pass->name, type->name, direction,
                                    ref.port, didYouMean(ref.port, type->portNames(wanted))));
            return nullptr;
        }
        if (info->direction == wanted) return info;
        const char* is = info->direction == PortDirection::Input    ? "is an input"
                         : info->direction == PortDirection::Output ? "is an output"
                                                                    : "is internal to its pass";
        note(where, fmt::format("'{}' {}; an {} is needed here", ref.text(), is, direction));
        return nullptr;
    }

    void checkEdge(const GraphEdge& edge) {
        const auto place = [&](const Location& end) { return end.line > 0 ? end : edge.where; };
        const PortInfo* from = port(edge.from, PortDirection::Output, place(edge.fromWhere));
        const PortInfo* to = port(edge.to, PortDirection::Input, place(edge.toWhere));
        if (from != nullptr && to != nullptr) checkFit(edge, *from, *to);
        if (from != nullptr && to != nullptr) sound_.push_back(&edge);
        const auto [first, fresh] = feeds_.try_emplace(edge.to, &edge);
        if (!fresh)
            note(edge.where, fmt::format("the input '{}' is connected twice ('{}' feeds it already)",
                                         edge.to.text(), first->second->from.text()));
    }

    void checkFit(const GraphEdge& edge, const PortInfo& from, const PortInfo& to) {
        if (from.kind != to.kind) {
            note(edge.where, fmt::format("a {} cannot feed a {} port: '{}' -> '{}'", portKindName(from.kind),
                                         portKindName(to.kind), edge.from.text(), edge.to.text()));
        } else if (const std::string mistake = contentMistake(from.content, to.content); !mistake.empty()) {
            note(edge.where, fmt::format("'{}' cannot feed '{}': it carries {}", edge.from.text(),
                                         edge.to.text(), mistake));
        }
    }

    // The passes that an output needs, directly or through others; all where there are no outputs yet.
    [[nodiscard]] std::set<std::string> wanted() const {
        std::unordered_map<std::string, std::vector<std::string>> producers;
        for (const GraphEdge& edge : graph_.edges) producers[edge.to.pass].push_back(edge.from.pass);
        std::vector<std::string> open;
        for (const GraphOutput& output : graph_.outputs) open.push_back(output.port.pass);
        if (graph_.outputs.empty())
            for (const GraphPass& pass : graph_.passes) open.push_back(pass.name);
        std::set<std::string> found;
        while (!open.empty()) {
            const std::string pass = std::move(open.back());
            open.pop_back();
            if (!found.insert(pass).second) continue;
            const std::vector<std::string>& more = producers[pass];
            open.insert(open.end(), more.begin(), more.end());
        }
        return found;
    }

    // A pass that stands by for another, connected to nothing, is left out; only what is wanted needs inputs.
    void checkRequiredInputs() {
        const std::set<std::string> needed = wanted();
        for (const GraphPass& pass : graph_.passes) {
            const PassType* type = typeOf(pass);
            if (type == nullptr || !needed.contains(pass.name)) continue;
            for (const PortInfo& info : type->ports)
                if (info.direction == PortDirection::Input && !info.optional &&
                    !feeds_.contains(PortRef{pass.name, info.name}))
                    note(pass.where, fmt::format("the input '{}.{}' ({}) is not connected", pass.name,
                                                 info.name, portKindName(info.kind)));
        }
    }

    void checkOutput(const GraphOutput& output, std::map<PortRef, Location>& seen) {
        const PortInfo* info = port(output.port, PortDirection::Output, output.where);
        if (info != nullptr && isModule(info->kind))
            note(output.where, fmt::format("'{}' is a {} module; only textures and buffers can be outputs",
                                           output.port.text(), portKindName(info->kind)));
        if (!seen.try_emplace(output.port, output.where).second)
            note(output.where, fmt::format("the output '{}' stands twice", output.port.text()));
    }

    // ---- cycles: depth first along the edges; the stack is the path (explicit, as graphs may be deep)
    void checkCycles() {
        std::unordered_map<std::string, std::vector<const GraphEdge*>> leaving;
        for (const GraphEdge* edge : sound_) leaving[edge->from.pass].push_back(edge);
        enum class Mark { Fresh, Open, Done };
        std::unordered_map<std::string, Mark> marks;
        struct Frame {
            const std::string* pass;
            size_t next;
        };
        for (const GraphPass& root : graph_.passes) {
            if (marks[root.name] != Mark::Fresh) continue;
            std::vector<Frame> stack = {{&root.name, 0}};
            std::vector<const GraphEdge*> path; // path[i] leads from stack[i] to stack[i + 1]
            marks[root.name] = Mark::Open;
            while (!stack.empty()) {
                Frame& top = stack.back();
                const auto& edges = leaving[*top.pass];
                if (top.next == edges.size()) {
                    marks[*top.pass] = Mark::Done;
                    stack.pop_back();
                    if (!path.empty()) path.pop_back();
                    continue;
                }
                const GraphEdge* edge = edges[top.next++];
                Mark& mark = marks[edge->to.pass];
                if (mark == Mark::Open) {
                    const auto begin = std::find_if(stack.begin(), stack.end(), [&](const Frame& frame) {
                        return *frame.pass == edge->to.pass;
                    });
                    noteCycle(*edge, path, static_cast<size_t>(begin - stack.begin()));
                } else if (mark == Mark::Fresh) {
                    mark = Mark::Open;
                    path.push_back(edge);
                    stack.push_back({&edge->to.pass, 0});
                }
            }
        }
    }

    void noteCycle(const GraphEdge& closing, const std::vector<const GraphEdge*>& path, size_t begin) {
        constexpr size_t shown = 100; // of the passes in a row
        std::string text;
        for (size_t i = begin; i < path.size(); ++i) {
            if (i - begin < shown) text += path[i]->from.text() + " -> ";
            if (i - begin == shown) text += fmt::format("({} more) -> ", path.size() - i);
        }
        text += closing.from.text() + " -> ";
        text += begin < path.size() ? path[begin]->from.text() : closing.from.text();
        note(closing.where, "the edges form a cycle: " + text);
    }

    const Graph& graph_;
    const Registry& registry_;
    std::unordered_map<std::string, const GraphPass*> byName_;
    std::map<PortRef, const GraphEdge*> feeds_;
    std::vector<const GraphEdge*> sound_; // from an output to an input that exist
    std::vector<Problem> problems_;
};

} // namespace

std::vector<Problem> validate(const Graph& graph, const Registry& registry) {
    return Validator(graph, registry).run();
}

} // namespace kestrel
