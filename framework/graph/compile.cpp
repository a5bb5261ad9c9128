// From a graph to a plan, in named stages; each has its own file.
#include "core/check.h"
#include "graph/barriers.h"
#include "graph/guard.h"
#include "graph/memory.h"
#include "graph/network.h"
#include "graph/plan.h"
#include <algorithm>
#include <filesystem>
#include <utility>

namespace kestrel {

PassSet makePasses(const Graph& graph, const Registry& registry) {
    PassSet passes;
    for (const GraphPass& document : graph.passes) {
        const PassType* type = registry.find(document.type);
        KESTREL_CHECK(type != nullptr);
        std::shared_ptr<Pass> pass = guarded(document.name, "construction", [&] { return type->make(); });
        pass->typeInstance = type->instance;
        setProperties(*pass, *type, document);
        passes.emplace(document.name, std::move(pass));
    }
    return passes;
}

void setProperties(Pass& pass, const PassType& type, const GraphPass& document) {
    for (const PropertyInfo& property : type.properties) {
        Value value = property.defaultValue;
        for (const auto& [name, given] : document.properties)
            if (name == property.name) value = given;
        KESTREL_CHECK(!valueMistake(property, value));
        // A file is named from the folder of the graph's.
        if (auto* file = std::get_if<std::string>(&value); property.unit == "file" && !file->empty())
            *file = (std::filesystem::path(document.where.file).parent_path() / *file).string();
        guarded(document.name, "a property", [&] { property.set(pass, value); });
    }
}

namespace {

Plan compileStages(const Graph& graph, const Registry& registry, const PassSet& passes, const World& world,
                   const CompileOptions& options) {
    using namespace compiler;

    // Resolve: names become nodes, ports and a topological order.
    Network network = resolve(graph, registry, passes, world, options);

    // Declare forward with every demand, propagate the real demand backward from the outputs, declare again,
    // until nothing changes. What is not asked for is left out.
    settleDemand(network);

    // Order: topological and stable; who changes something in place comes after its other readers.
    const Order order = orderPasses(network);

    // Give out resources, compose the shader variants of all steps, bind.
    Plan plan = allocateResources(network, order);

    // Transient resources with disjoint lifetimes share memory.
    assignObjects(plan, options.shareMemory);

    // Barriers, by what shares bytes: sharing moves hazards from one resource to another.
    planBarriers(plan);

    plan.leftOut = reportLeftOut(network);
    return plan;
}

std::uint64_t heldBytes(const MemoryReport& memory) { return memory.transient + memory.persistent; }

// The steps of a plan by "pass.step", each with what tells whether it does the same: program and bindings.
std::map<std::string, std::string> stepTexts(const Plan& plan) {
    std::map<std::string, std::string> texts;
    for (const PlanStep& step : plan.steps) {
        std::string text;
        for (const std::string& file : step.step.shaders) text += file + " ";
        for (const auto& [name, value] : step.step.defines) text += name + "=" + value + " ";
        for (const PlanBinding& binding : step.bindings) text += binding.name + " " + binding.port + " ";
        texts.emplace(plan.passes[static_cast<size_t>(step.pass)].name + "." + step.step.name,
                      std::move(text));
    }
    return texts;
}

// Looking changes nothing: the figures are those without previews, what these cost stands apart.
void setPreviewsApart(Plan& plan, const Plan& without) {
    plan.previews.memory =
        heldBytes(plan.memory) - std::min(heldBytes(plan.memory), heldBytes(without.memory));
    plan.previews.leftOut = std::exchange(plan.leftOut, without.leftOut);
    plan.memory = without.memory;
    const auto before = stepTexts(without), now = stepTexts(plan);
    for (PlanStep& step : plan.steps) {
        const std::string name = plan.passes[static_cast<size_t>(step.pass)].name + "." + step.step.name;
        const auto known = before.find(name);
        step.preview = known == before.end();
        if (!step.preview && known->second != now.at(name)) plan.previews.altered.push_back(name);
    }
}

} // namespace

Plan compile(const Graph& graph, const Registry& registry, const PassSet& passes, const World& world,
             const CompileOptions& options) {
    if (auto problems = validate(graph, registry); !problems.empty()) throw InputError(std::move(problems));
    Plan plan = compileStages(graph, registry, passes, world, options);
    if (options.previews.empty()) return plan;
    CompileOptions without = options;
    without.previews.clear();
    // A graph without outputs has nothing but previews.
    if (!graph.outputs.empty())
        setPreviewsApart(plan, compileStages(graph, registry, passes, world, without));
    return plan;
}

} // namespace kestrel
