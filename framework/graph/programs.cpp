// Compiler stage: shader variants, and the names by which resources are bound in them.
#include "graph/glsl_names.h"
#include "graph/many_rays.h"
#include "graph/network.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel::compiler {
namespace {

bool isTexel(Access access) { return access == Access::Fetch || access == Access::Image; }

// Whether the same step or module reads this use's port as texels by another use.
bool readBeside(const std::vector<Use>& uses, const Use& use) {
    return use.write && use.access == Access::Image &&
           std::any_of(uses.begin(), uses.end(), [&](const Use& other) {
               return !other.write && isTexel(other.access) && other.port == use.port &&
                      other.previous == use.previous;
           });
}

// The resource that `port` of a node stands for: its own output, or its input's producer.
std::optional<Source> sourceOf(const Network& network, int node, const std::string& port) {
    if (isInput(network.at(node), port)) return originOfInput(network, node, port);
    return origin(network, {node, port});
}

void bindUses(const Network& network, int node, const std::vector<Use>& uses, const std::string& prefix,
              std::vector<BoundUse>& bound) {
    for (const Use& use : uses) {
        const auto source = sourceOf(network, node, use.port);
        if (!source) continue;
        const Output* output = knownOutput(network.at(source->node), source->port);
        const ResourceKind kind = output == nullptr ? ResourceKind::Texture2D : output->desc.kind;
        bound.push_back({glslName(prefix, use, kind, readBeside(uses, use)), prefix, *source, use});
    }
}

// The module that stands behind an input, with the node that provides it.
struct Provider {
    int node;
    const Module* module;
};
std::optional<Provider> providerOf(const Network& network, int node, const std::string& input) {
    const auto source = originOfInput(network, node, input);
    if (!source) return {};
    const Module* module = findModule(network.at(source->node).real, source->port);
    if (module == nullptr) return {};
    return Provider{source->node, module};
}

void bindModules(const Network& network, int node, const std::vector<ModuleUse>& modules,
                 const std::string& prefix, std::vector<BoundUse>& bound) {
    for (const ModuleUse& use : modules) {
        const auto provider = providerOf(network, node, use.port);
        if (!provider) continue;
        const std::string inner = prefix + use.port + "_";
        bindUses(network, provider->node, provider->module->uses, inner, bound);
        bindModules(network, provider->node, provider->module->modules, inner, bound);
    }
}

// What a consumer requests reaches the module as defines. A module inside a module is asked by the inner one,
// but may snap only if the outermost consumer bears it, and has rays by number only from one that has them.
ModuleInstance instanceOf(const Network& network, const Provider& provider, Bits taken) {
    ModuleInstance instance{provider.module->shader, provider.module->defines, {}};
    constexpr std::pair<Bits, const char*> defines[] = {{requests::AnyHit, "REQUESTS_ANY"},
                                                        {requests::ClosestHit, "REQUESTS_CLOSEST"},
                                                        {requests::Surface, "REQUESTS_SURFACE"},
                                                        {requests::Snap, "REQUESTS_SNAP"},
                                                        {requests::AllHits, "REQUESTS_ALL"},
                                                        {requests::ManyRays, "REQUESTS_MANY"},
                                                        {requests::ManyClosest, "REQUESTS_MANY_CLOSEST"}};
    constexpr Bits outermost = requests::Snap | requests::ManyRays | requests::ManyClosest;
    for (const auto& [bit, name] : defines)
        if ((taken & bit) != 0) instance.defines[name] = "1";
    for (const ModuleUse& use : provider.module->modules) {
        const auto inner = providerOf(network, provider.node, use.port);
        if (!inner) continue;
        instance.modules[use.port] = instanceOf(network, *inner, use.requests & (taken | ~outermost));
    }
    return instance;
}

// The views that a program of this node can ask for under a path: of what it binds, and of its other ports.
void addViews(const Network& network, int node, const std::string& path, std::vector<BoundView>& views) {
    const Node& at = network.at(node);
    for (const PortInfo& port : at.type->ports) {
        if (isModule(port.kind)) continue;
        const Desc* desc = nullptr;
        if (port.direction == PortDirection::Input) {
            if (at.inputs.connected(port.name)) desc = &at.inputs[port.name].desc;
        } else if (const Output* output = findOutput(at.real, port.name)) {
            desc = &output->desc;
        }
        if (desc == nullptr) continue;
        const auto source = sourceOf(network, node, port.name);
        for (const bool previous : {false, true})
            views.push_back(
                {viewBlockName(path, port.name, previous), previous, source, desc->view, desc->extent});
    }
}

void addViewsOfModules(const Network& network, int node, const std::vector<ModuleUse>& modules,
                       const std::string& path, std::vector<BoundView>& views) {
    for (const ModuleUse& use : modules) {
        const auto provider = providerOf(network, node, use.port);
        if (!provider) continue;
        const std::string inner = path + use.port + "_";
        addViews(network, provider->node, inner, views);
        addViewsOfModules(network, provider->node, provider->module->modules, inner, views);
    }
}

void addProducers(const Network& network, int node, const std::string& input, std::set<int>& producers) {
    const auto source = originOfInput(network, node, input);
    if (!source) return;
    producers.insert(source->node);
    const Node& producer = network.at(source->node);
    const Module* module = findModule(producer.real, source->port);
    if (module == nullptr) return;
    for (const Use& use : module->uses)
        if (isInput(producer, use.port)) addProducers(network, source->node, use.port, producers);
    for (const ModuleUse& use : module->modules) addProducers(network, source->node, use.port, producers);
}

} // namespace

std::vector<BoundUse> boundUses(const Network& network, int node, const Step& step) {
    std::vector<BoundUse> bound;
    bindUses(network, node, step.uses, "", bound);
    bindModules(network, node, step.modules, "", bound);
    return bound;
}

ProgramRequest programOf(const Network& network, int node, const Step& step) {
    ProgramRequest request{step.shaders, step.defines, {}};
    for (const ModuleUse& use : step.modules)
        if (const auto provider = providerOf(network, node, use.port))
            request.modules[use.port] = instanceOf(network, *provider, use.requests);
    return request;
}

std::vector<BoundView> viewsOf(const Network& network, int node, const Step& step) {
    std::vector<BoundView> views;
    addViews(network, node, "", views);
    addViewsOfModules(network, node, step.modules, "", views);
    return views;
}

std::set<int> producersBehind(const Network& network, int node, const std::string& input) {
    std::set<int> producers;
    addProducers(network, node, input, producers);
    return producers;
}

} // namespace kestrel::compiler
