// From a graph to a plan, in named stages; each has its own file.
#include "core/check.h"
#include "graph/barriers.h"
#include "graph/guard.h"
#include "graph/memory.h"
#include "graph/network.h"
#include "graph/plan.h"

namespace kestrel {

PassSet makePasses(const Graph& graph, const Registry& registry) {
    PassSet passes;
    for (const GraphPass& document : graph.passes) {
        const PassType* type = registry.find(document.type);
        KESTREL_CHECK(type != nullptr);
        std::shared_ptr<Pass> pass = guarded(document.name, "construction", [&] { return type->make(); });
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
        guarded(document.name, "a property", [&] { property.set(pass, value); });
    }
}

Plan compile(const Graph& graph, const Registry& registry, const PassSet& passes, const World& world,
             const CompileOptions& options) {
    using namespace compiler;
    if (auto problems = validate(graph, registry); !problems.empty()) throw InputError(std::move(problems));

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

} // namespace kestrel
