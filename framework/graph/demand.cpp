// Compiler stages: declare forward with every demand, propagate the real demand backward, declare again.
#include "core/check.h"
#include "graph/guard.h"
#include "graph/network.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel::compiler {
namespace {

// What the input ports of a node look like, by what their producers declare at present.
Inputs inputsOf(const Network& network, const Node& node) {
    Inputs inputs;
    for (const auto& [port, source] : node.feeds) {
        const Node& producer = network.at(source.node);
        const Output* output = producer.impossible.empty() ? knownOutput(producer, source.port) : nullptr;
        if (output == nullptr) continue;
        if (!output->same.empty()) {
            if (producer.inputs.connected(output->same)) inputs.set(port, producer.inputs[output->same]);
            continue;
        }
        Inputs::Input input{output->desc, {}, producer.possible};
        if (output->desc.kind == ResourceKind::Module) input.causes = producer.modulePossible;
        if (output->constant && !network.options.keepAll) {
            input.constant = output->constant;
            input.causes = Causes::None;
        }
        inputs.set(port, std::move(input));
    }
    return inputs;
}

// Of the declared causes those that can come up in this world.
Causes withinFacts(Causes causes, const SceneFacts& facts) {
    if (!facts.geometryMoves && !facts.geometryDeforms)
        causes = causes & ~(Causes::Geometry | Causes::Transforms);
    if (!facts.cameraMoves) causes = causes & ~(Causes::Camera | Causes::Cameras);
    if (!facts.lightsMove) causes = causes & ~Causes::Lights;
    return causes;
}

void readsOfStep(const Node& node, const Step& step,
                 const std::function<void(const std::string&, Bits)>& visit) {
    for (const Use& use : step.uses)
        if (isInput(node, use.port)) visit(use.port, 0);
    for (const ModuleUse& use : step.modules) visit(use.port, use.requests);
}

void readsOfModule(const Node& node, const Module& module,
                   const std::function<void(const std::string&, Bits)>& visit) {
    for (const Use& use : module.uses)
        if (isInput(node, use.port)) visit(use.port, 0);
    for (const ModuleUse& use : module.modules) visit(use.port, use.requests);
}

void findPossibleCauses(const Network& network, Node& node) {
    const Declaration& declaration = node.live ? node.real : node.full;
    const auto gather = [&](Causes& causes) {
        return [&](const std::string& port, Bits) {
            if (node.inputs.connected(port)) causes |= node.inputs[port].causes;
        };
    };
    node.possible = node.modulePossible = withinFacts(declaration.depends, network.world.facts);
    // What always runs may hold something new in every frame.
    if (declaration.always) node.possible = node.modulePossible = node.possible | Causes::Frame;
    for (const Step& step : declaration.steps) readsOfStep(node, step, gather(node.possible));
    for (const Output& output : declaration.outputs)
        if (!output.updates.empty()) gather(node.possible)(output.updates, 0);
    for (const Module& module : declaration.modules) readsOfModule(node, module, gather(node.modulePossible));
}

// Why a pass does not make what it was to make; empty if it does not say.
std::string whyNotMade(const Node& producer) {
    if (!producer.impossible.empty()) return producer.impossible;
    return producer.full.problems.empty() ? std::string() : producer.full.problems.front().message;
}

// Why a pass cannot run: a required input whose producer does not make it.
std::string whyImpossible(const Network& network, const Node& node) {
    for (const PortInfo& port : node.type->ports) {
        if (port.direction != PortDirection::Input || port.optional || node.inputs.connected(port.name))
            continue;
        const auto feed = node.feeds.find(port.name);
        if (feed == node.feeds.end()) return fmt::format("its input '{}' is not connected", port.name);
        const std::string reason = whyNotMade(network.at(feed->second.node));
        return fmt::format("its input '{}' needs '{}', which is not made here{}{}", port.name,
                           network.text(feed->second), reason.empty() ? "" : ": ", reason);
    }
    return {};
}

} // namespace

Declaration declare(const Network& network, const Node& node, Demand demand) {
    if (node.grown != nullptr) demand.setGrown(*node.grown);
    Declaration declaration = guarded(
        node.name(), "declare", [&] { return node.instance->declare(network.world, node.inputs, demand); });
    for (Output& output : declaration.outputs) {
        const std::string& like = output.same.empty() ? output.updates : output.same;
        if (!like.empty() && node.inputs.connected(like)) output.desc = node.inputs[like].desc;
    }
    // What is seen from elsewhere than the frame's camera changes as that does.
    for (const Output& output : declaration.outputs)
        if (output.same.empty() && output.updates.empty() && !output.constant)
            declaration.depends |= causesOf(output.desc.view);
    for (const Module& module : declaration.modules)
        if (findOutput(declaration, module.port) == nullptr) {
            Output output;
            output.port = module.port;
            output.desc = Desc::module(0);
            declaration.outputs.push_back(std::move(output));
        }
    return declaration;
}

void declareForwardWithEveryDemand(Network& network) {
    const Demand everything = Demand::everything();
    for (const int i : network.order) {
        Node& node = network.at(i);
        node.inputs = inputsOf(network, node);
        node.impossible = whyImpossible(network, node);
        if (!node.impossible.empty()) continue;
        node.full = declare(network, node, everything);
        findPossibleCauses(network, node);
        node.fallsBack =
            network.options.keepAll &&
            (!node.full.problems.empty() || !checkDeclaration(network, i, node.full, everything).empty());
    }
}

namespace {

// One sweep from the wanted outputs to the sources. Whether any demand changed.
bool propagateBackward(Network& network) {
    std::vector<Demand> asked(network.nodes.size(), Demand::nothing());
    for (const Source& source : network.wanted) asked[static_cast<size_t>(source.node)].add(source.port);
    bool changed = false;
    for (auto i = network.order.rbegin(); i != network.order.rend(); ++i) {
        Node& node = network.at(*i);
        const Demand demand = network.options.keepAll && !node.fallsBack ? Demand::everything()
                                                                         : asked[static_cast<size_t>(*i)];
        const bool live = node.impossible.empty() && demand.any();
        if (live != node.live || demand != node.demand) {
            node.live = live;
            node.demand = demand;
            node.real = live ? declare(network, node, demand) : Declaration();
            changed = true;
        }
        if (!live) continue;
        forEachRead(node, node.real, demand, [&](const std::string& port, Bits requests) {
            const auto feed = node.feeds.find(port);
            if (feed != node.feeds.end())
                asked[static_cast<size_t>(feed->second.node)].add(feed->second.port, requests);
        });
    }
    return changed;
}

// One sweep from the sources on: new descriptors and constants, and declarations made with them.
bool declareForwardAgain(Network& network) {
    bool changed = false;
    for (const int i : network.order) {
        Node& node = network.at(i);
        if (!node.impossible.empty()) continue;
        Inputs inputs = inputsOf(network, node);
        if (inputs != node.inputs) {
            node.inputs = std::move(inputs);
            if (node.live) node.real = declare(network, node, node.demand);
            changed = true;
        }
        findPossibleCauses(network, node);
    }
    return changed;
}

// The pass for which one cannot run: whose input the first on the way back from it does not get.
const Node& culprit(const Network& network, const Node& node) {
    if (node.impossible.empty()) return node;
    for (const PortInfo& port : node.type->ports) {
        if (port.direction != PortDirection::Input || port.optional || node.inputs.connected(port.name))
            continue;
        const auto feed = node.feeds.find(port.name);
        return feed == node.feeds.end() ? node : culprit(network, network.at(feed->second.node));
    }
    return node;
}

void noteMissingOutputs(const Network& network, std::vector<Problem>& problems) {
    for (size_t i = 0; i < network.graph.outputs.size(); ++i) {
        const Source& source = network.wanted[i];
        const Node& node = network.at(source.node);
        if (node.live && findOutput(node.real, source.port) != nullptr) continue;
        // A mistake of a value is told where the value stands.
        if (const Node& cause = culprit(network, node); &cause != &node && !cause.full.problems.empty()) {
            const DeclarationProblem& problem = cause.full.problems.front();
            problems.push_back(
                {placeOf(cause, problem.port),
                 fmt::format("pass '{}' ({}){}: {}, so that the output '{}' cannot be made", cause.name(),
                             cause.type->name, problem.port.empty() ? "" : ", '" + problem.port + "'",
                             problem.message, network.text(source))});
            continue;
        }
        std::string why = node.impossible.empty()
                              ? fmt::format("pass '{}' does not make it here", node.name())
                              : node.impossible;
        for (const LeftOut& left : node.full.leftOut)
            if (left.what == source.port) why = left.why;
        problems.push_back({network.graph.outputs[i].where,
                            fmt::format("the output '{}' cannot be made: {}", network.text(source), why)});
    }
}

// Whoever is asked for an output that it declared before must declare it still.
void noteBrokenPromises(const Network& network, const Node& node, std::vector<Problem>& problems) {
    forEachRead(node, node.real, node.demand, [&](const std::string& port, Bits) {
        const auto feed = node.feeds.find(port);
        if (feed == node.feeds.end() || !node.inputs.connected(port)) return;
        const Node& producer = network.at(feed->second.node);
        if (findOutput(producer.real, feed->second.port) == nullptr)
            problems.push_back(
                {producer.document->where,
                 fmt::format("pass '{}' ({}) does not declare '{}' any more when '{}' asks for it",
                             producer.name(), producer.type->name, feed->second.port, node.name())});
    });
}

void refuseProblems(const Network& network) {
    std::vector<Problem> problems;
    bool machine = true; // nothing is wrong but the machine
    for (int i = 0; i < static_cast<int>(network.nodes.size()); ++i) {
        const Node& node = network.at(i);
        if (!node.live) continue;
        std::vector<DeclarationProblem> found = node.real.problems;
        for (auto& problem : checkDeclaration(network, i, node.real, node.demand))
            found.push_back(std::move(problem));
        const size_t before = problems.size();
        noteBrokenPromises(network, node, problems);
        machine = machine && problems.size() == before;
        for (const DeclarationProblem& problem : found) {
            problems.push_back(
                {placeOf(node, problem.port),
                 fmt::format("pass '{}' ({}){}: {}", node.name(), node.type->name,
                             problem.port.empty() ? "" : ", '" + problem.port + "'", problem.message)});
            machine = machine && problem.machine;
        }
    }
    const size_t known = problems.size();
    noteMissingOutputs(network, problems);
    machine = machine && problems.size() == known;
    std::stable_sort(problems.begin(), problems.end(), [](const Problem& a, const Problem& b) {
        return std::pair(a.where.line, a.where.column) < std::pair(b.where.line, b.where.column);
    });
    if (problems.empty()) return;
    if (machine) throw MachineError(std::move(problems));
    throw InputError(std::move(problems));
}

} // namespace

void forEachRead(const Node& node, const Declaration& declaration, const Demand& demand,
                 const std::function<void(const std::string& port, Bits requests)>& visit) {
    for (const Step& step : declaration.steps) readsOfStep(node, step, visit);
    for (const Module& module : declaration.modules)
        if (demand.reads(module.port)) readsOfModule(node, module, visit);
    for (const Output& output : declaration.outputs) {
        if (!demand.reads(output.port)) continue;
        if (!output.same.empty()) visit(output.same, demand.requests(output.port));
        if (!output.updates.empty()) visit(output.updates, 0);
    }
}

void settleDemand(Network& network) {
    declareForwardWithEveryDemand(network);
    // A change travels at least one pass further with each round, and asking for less never asks for more.
    const size_t rounds = network.nodes.size() + 8;
    for (size_t round = 0; round < rounds; ++round) {
        const bool demandChanged = propagateBackward(network);
        const bool inputsChanged = declareForwardAgain(network);
        if (!demandChanged && !inputsChanged) {
            refuseProblems(network);
            return;
        }
    }
    throw InputError(Location{network.graph.file.string()},
                     "the passes' declarations do not settle: one asks for more when less is asked of it");
}

} // namespace kestrel::compiler
