// Compiler stage: names become nodes and ports.
#include "core/check.h"
#include "graph/muted.h"
#include "graph/network.h"
#include "scene/fact_list.h"
#include <fmt/format.h>
#include <queue>

namespace kestrel::compiler {
namespace {

using Index = std::map<std::string, int, std::less<>>;

// The source behind a port that somebody wants to see; an input stands for its producer.
std::optional<Source> wantedSource(const Network& network, const Index& index, const PortRef& port,
                                   std::vector<Problem>& problems) {
    const auto note = [&](const std::string& message) { problems.push_back({{}, message}); };
    const auto found = index.find(port.pass);
    if (found == index.end()) {
        std::vector<std::string> names;
        for (const Node& node : network.nodes) names.push_back(node.name());
        note(fmt::format("there is no pass '{}' (in '{}'){}", port.pass, port.text(),
                         didYouMean(port.pass, names)));
        return {};
    }
    const Node& node = network.at(found->second);
    const PortInfo* info = node.type->port(port.port);
    if (info == nullptr) {
        std::vector<std::string> names;
        for (const PortInfo& candidate : node.type->ports) names.push_back(candidate.name);
        note(fmt::format("pass '{}' ({}) has no port '{}'{}", port.pass, node.type->name, port.port,
                         didYouMean(port.port, names)));
        return {};
    }
    if (isModule(info->kind)) {
        note(fmt::format("'{}' is a {} module; only textures and buffers can be seen", port.text(),
                         portKindName(info->kind)));
        return {};
    }
    if (info->direction != PortDirection::Input) return Source{found->second, port.port};
    const auto feed = node.feeds.find(port.port);
    if (feed != node.feeds.end()) return feed->second;
    note(fmt::format("the input '{}' is not connected", port.text()));
    return {};
}

} // namespace

std::vector<int> topologicalOrder(const std::vector<std::set<int>>& before) {
    std::vector<int> missing(before.size(), 0);
    for (const std::set<int>& followers : before)
        for (const int follower : followers) ++missing[static_cast<size_t>(follower)];
    std::priority_queue<int, std::vector<int>, std::greater<>> ready;
    for (size_t i = 0; i < before.size(); ++i)
        if (missing[i] == 0) ready.push(static_cast<int>(i));
    std::vector<int> order;
    while (!ready.empty()) {
        const int node = ready.top();
        ready.pop();
        order.push_back(node);
        for (const int follower : before[static_cast<size_t>(node)])
            if (--missing[static_cast<size_t>(follower)] == 0) ready.push(follower);
    }
    if (order.size() != before.size()) order.clear();
    return order;
}

Network resolve(const Graph& graph, const Registry& registry, const PassSet& passes, const World& world,
                const CompileOptions& options) {
    Network network{graph, options, world, {}, {}, {}};
    if (options.keepAll) network.world.facts = withoutPromises(world.facts);
    Index index;
    for (const GraphPass& pass : graph.passes) {
        Node node;
        node.document = &pass;
        node.type = registry.find(pass.type);
        const auto instance = passes.find(pass.name);
        KESTREL_CHECK(instance != passes.end() && instance->second != nullptr);
        node.instance = pass.muted ? mutedPass(*node.type) : instance->second;
        if (const auto grown = options.grown.find(pass.name); grown != options.grown.end())
            node.grown = &grown->second;
        index[pass.name] = static_cast<int>(network.nodes.size());
        network.nodes.push_back(std::move(node));
    }
    std::vector<std::set<int>> before(network.nodes.size());
    for (const GraphEdge& edge : graph.edges) {
        const int from = index.at(edge.from.pass), to = index.at(edge.to.pass);
        network.at(to).feeds[edge.to.port] = {from, edge.from.port};
        network.at(to).feedWhere[edge.to.port] = edge.where;
        before[static_cast<size_t>(from)].insert(to);
    }
    network.order = topologicalOrder(before);
    KESTREL_CHECK_EQ(network.order.size(), network.nodes.size()); // a valid graph has no cycle

    for (const GraphOutput& output : graph.outputs)
        network.wanted.push_back({index.at(output.port.pass), output.port.port});
    std::vector<Problem> problems;
    for (const PortRef& preview : options.previews)
        if (auto source = wantedSource(network, index, preview, problems))
            network.wanted.push_back(std::move(*source));
    if (!problems.empty()) throw InputError(std::move(problems));
    return network;
}

const Output* findOutput(const Declaration& declaration, std::string_view port) {
    for (const Output& output : declaration.outputs)
        if (output.port == port) return &output;
    return nullptr;
}

const Module* findModule(const Declaration& declaration, std::string_view port) {
    for (const Module& module : declaration.modules)
        if (module.port == port) return &module;
    return nullptr;
}

const Output* knownOutput(const Node& node, std::string_view port) {
    const Output* real = findOutput(node.real, port);
    return real != nullptr ? real : findOutput(node.full, port);
}

Source origin(const Network& network, Source source) {
    while (true) {
        const Node& node = network.at(source.node);
        const Output* output = knownOutput(node, source.port);
        if (output == nullptr || output->same.empty()) return source;
        const auto feed = node.feeds.find(output->same);
        if (feed == node.feeds.end()) return source;
        source = feed->second;
    }
}

std::optional<Source> originOfInput(const Network& network, int node, std::string_view input) {
    const auto feed = network.at(node).feeds.find(input);
    if (feed == network.at(node).feeds.end()) return {};
    return origin(network, feed->second);
}

bool isInput(const Node& node, std::string_view port) {
    const PortInfo* info = node.type->port(port);
    return info != nullptr && info->direction == PortDirection::Input;
}

Location placeOf(const Node& node, const std::string& port) {
    const auto property = node.document->propertyWhere.find(port);
    if (property != node.document->propertyWhere.end()) return property->second;
    const auto feed = node.feedWhere.find(port);
    return feed != node.feedWhere.end() ? feed->second : node.document->where;
}

} // namespace kestrel::compiler
