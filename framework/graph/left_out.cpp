// Compiler stage: says what is left out, and why. Nothing is left out silently.
#include "graph/network.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel::compiler {
namespace {

// The inputs that an output feeds.
struct Reader {
    int node;
    std::string input;
};
using Readers = std::map<Source, std::vector<Reader>>;

Readers readersOf(const Network& network) {
    Readers readers;
    for (int i = 0; i < static_cast<int>(network.nodes.size()); ++i)
        for (const auto& [input, source] : network.at(i).feeds) readers[source].push_back({i, input});
    return readers;
}

std::string quotedList(const std::vector<std::string>& names, const char* lastWord) {
    std::string text;
    for (size_t i = 0; i < names.size(); ++i) {
        if (i > 0) text += i + 1 == names.size() ? fmt::format(" {} ", lastWord) : ", ";
        text += "'" + names[i] + "'";
    }
    return text;
}

// Why nobody asks for a pass.
std::string whyNobodyAsks(const Network& network, const Readers& readers, int index) {
    std::vector<std::string> outputs, leftOut, live;
    for (const std::string& port : network.at(index).type->portNames(PortDirection::Output)) {
        outputs.push_back(network.at(index).name() + "." + port);
        const auto found = readers.find({index, port});
        if (found == readers.end()) continue;
        for (const Reader& reader : found->second) {
            const Node& node = network.at(reader.node);
            if (node.live)
                live.push_back(node.name() + "." + reader.input);
            else if (std::find(leftOut.begin(), leftOut.end(), node.name()) == leftOut.end())
                leftOut.push_back(node.name());
        }
    }
    if (!live.empty()) return fmt::format("{} does not need it here", quotedList(live, "and"));
    if (!leftOut.empty())
        return fmt::format("only {} would read it, which {} left out", quotedList(leftOut, "and"),
                           leftOut.size() == 1 ? "is" : "are");
    return fmt::format("nobody reads {}", quotedList(outputs, "or"));
}

void reportOutputs(const Network& network, int index, std::vector<LeftOut>& report) {
    const Node& node = network.at(index);
    for (const Output& output : node.real.outputs) {
        if (!node.demand.reads(output.port)) continue;
        const std::string what = node.name() + "." + output.port;
        if (!output.same.empty())
            report.push_back({what, fmt::format("it is the same as the input '{}'", output.same)});
        else if (output.constant && !network.options.keepAll)
            report.push_back(
                {what, fmt::format("it is {:.6g}, {:.6g}, {:.6g}, {:.6g} everywhere", output.constant->x,
                                   output.constant->y, output.constant->z, output.constant->w)});
    }
    for (const Output& output : node.full.outputs) {
        const PortInfo* port = node.type->port(output.port);
        if (port != nullptr && port->direction == PortDirection::Output && !node.demand.reads(output.port) &&
            findOutput(node.real, output.port) ==
                nullptr) // a pass may need for itself what nobody else reads
            report.push_back({node.name() + "." + output.port, "nobody reads it"});
    }
    for (const LeftOut& own : node.real.leftOut)
        report.push_back({fmt::format("{}: {}", node.name(), own.what), own.why});
}

} // namespace

std::vector<LeftOut> reportLeftOut(const Network& network) {
    const Readers readers = readersOf(network);
    std::vector<LeftOut> report;
    for (int i = 0; i < static_cast<int>(network.nodes.size()); ++i) {
        const Node& node = network.at(i);
        if (!node.impossible.empty())
            report.push_back({node.name(), node.impossible});
        else if (!node.live)
            report.push_back({node.name(), node.fallsBack ? "it cannot bear every demand, and " +
                                                                whyNobodyAsks(network, readers, i)
                                                          : whyNobodyAsks(network, readers, i)});
        else
            reportOutputs(network, i, report);
    }
    return report;
}

} // namespace kestrel::compiler
