#include "graph/fact_effects.h"
#include "graph/network.h"
#include "scene/fact_list.h"
#include <algorithm>
#include <utility>

namespace kestrel::compiler {
namespace {

// What a timeline brings.
constexpr Causes timeline =
    Causes::Frame | Causes::Camera | Causes::Cameras | Causes::Geometry | Causes::Transforms | Causes::Lights;

World worldOf(const SceneFacts& facts) {
    World world;
    world.facts = facts;
    world.capabilities = Capabilities::unlimited();
    return world;
}

// What stands alike in a step and in a module.
template<class Part>
void comparePart(const Part& all, const Part& held, FactEffect& effect) {
    for (const auto& [name, value] : all.defines) {
        const auto left = held.defines.find(name);
        if (left == held.defines.end() || (left->second == "0" && value != "0")) effect.defines.insert(name);
    }
    const auto reads = [](const Part& part) {
        std::set<std::string> ports;
        for (const Use& use : part.uses)
            if (!use.write) ports.insert(use.port);
        for (const ModuleUse& use : part.modules) ports.insert(use.port);
        return ports;
    };
    const std::set<std::string> left = reads(held);
    for (const std::string& port : reads(all))
        if (!left.contains(port)) effect.reads.insert(port);
}

void compareOutputs(const Declaration& all, const Declaration& held, FactEffect& effect) {
    for (const Output& output : all.outputs) {
        if (output.constant || !output.same.empty()) continue;
        const Output* left = findOutput(held, output.port);
        if (left == nullptr || left->constant || !left->same.empty())
            effect.constants.insert(output.port);
        else if (left->desc.totalBytes() < output.desc.totalBytes())
            effect.smaller.insert(output.port);
    }
}

void compare(const Declaration& all, const Declaration& held, FactEffect& effect) {
    for (const Step& step : all.steps) {
        const auto left = std::ranges::find(held.steps, step.name, &Step::name);
        if (left == held.steps.end())
            effect.steps.insert(step.name);
        else
            comparePart(step, *left, effect);
    }
    effect.nothingRuns |= !all.steps.empty() && held.steps.empty();
    for (const Module& module : all.modules)
        if (const Module* left = findModule(held, module.port); left != nullptr)
            comparePart(module, *left, effect);
    compareOutputs(all, held, effect);
    for (const LeftOut& own : held.leftOut) {
        const bool before = std::ranges::any_of(all.leftOut, [&](const LeftOut& other) {
            return other.what == own.what && other.why == own.why;
        });
        if (!before) effect.leftOut.emplace(own.what, own.why);
    }
}

void compareCauses(const Node& all, const Node& held, FactEffect& effect) {
    const Causes before = (all.possible | all.modulePossible) & timeline,
                 after = (held.possible | held.modulePossible) & timeline;
    effect.causes |= before & ~after;
    effect.once |= any(before) && !any(after) && !held.full.steps.empty();
}

// The pass as the graph sets it, then each of its switches at each of its values.
std::vector<std::pair<const PropertyInfo*, Value>> variantsOf(const PassType& type) {
    std::vector<std::pair<const PropertyInfo*, Value>> variants = {{nullptr, {}}};
    for (const PropertyInfo& property : type.properties) {
        if (property.kind == PropertyKind::Bool)
            for (const bool on : {false, true}) variants.emplace_back(&property, on);
        if (property.kind == PropertyKind::Choice)
            for (const std::string& choice : property.choices) variants.emplace_back(&property, choice);
    }
    return variants;
}

using Effects = std::map<std::pair<size_t, std::string>, FactEffect>; // by fact and type of pass

class GraphFacts {
public:
    GraphFacts(const Registry& registry, const Graph& graph)
        : registry_(registry)
        , graph_(graph)
        , passes_(makePasses(graph, registry))
        , all_(network(richFacts())) {}

    void add(size_t fact, Effects& effects) {
        SceneFacts facts = richFacts();
        sceneFactList()[fact].hold(facts);
        Network held = network(facts);
        for (const int i : all_.order) {
            const Node &node = all_.at(i), &other = held.at(i);
            // What cannot run at all for want of what another pass leaves out is that pass's effect.
            if (!node.impossible.empty() || !other.impossible.empty() || node.document->muted) continue;
            FactEffect& effect = effects[{fact, node.type->name}];
            compareCauses(node, other, effect);
            addVariants(node, other, held, effect);
        }
    }

private:
    Network network(const SceneFacts& facts) const {
        Network made = resolve(graph_, registry_, passes_, worldOf(facts), options_);
        declareForwardWithEveryDemand(made);
        return made;
    }

    // With the inputs that it has: its own switches change what it makes of them.
    void addVariants(const Node& node, const Node& other, const Network& held, FactEffect& effect) const {
        for (const auto& [property, value] : variantsOf(*node.type)) {
            if (property != nullptr) property->set(*node.instance, value);
            const Declaration all = declare(all_, node, Demand::everything()),
                              less = declare(held, other, Demand::everything());
            if (all.problems.empty() && less.problems.empty()) compare(all, less, effect);
            if (property != nullptr) setProperties(*node.instance, *node.type, *node.document);
        }
    }

    const Registry& registry_;
    const Graph& graph_;
    CompileOptions options_;
    PassSet passes_;
    Network all_; // of a scene of which no fact holds
};

} // namespace
} // namespace kestrel::compiler

namespace kestrel {

std::vector<FactEffect> factEffects(const Registry& registry, std::span<const Graph> graphs) {
    compiler::Effects effects;
    for (const Graph& graph : graphs) {
        compiler::GraphFacts facts(registry, graph);
        for (size_t fact = 0; fact < sceneFactList().size(); ++fact) facts.add(fact, effects);
    }
    std::vector<FactEffect> found;
    for (auto& [key, effect] : effects) {
        if (!effect.isLess() && effect.leftOut.empty()) continue;
        effect.fact = sceneFactList()[key.first].name;
        effect.pass = key.second;
        found.push_back(std::move(effect));
    }
    return found;
}

} // namespace kestrel
