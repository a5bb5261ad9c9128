// Pass types made of lambdas, for tests of everything that needs no GL.
#pragma once
#include "graph/plan.h"
#include "support/message.h"
#include <algorithm>
#include <functional>

namespace kestrel::test {

using Declare = std::function<Declaration(const World&, const Inputs&, const Demand&)>;

class MockPass final : public Pass {
public:
    explicit MockPass(Declare declareIt)
        : declare_(std::move(declareIt)) {}
    Declaration declare(const World& world, const Inputs& inputs, const Demand& demand) const override {
        return declare_(world, inputs, demand);
    }
    void execute(const Step&, Commands&) override {}

private:
    Declare declare_;
};

inline PortInfo in(std::string name, PortKind kind = PortKind::Texture) {
    return {std::move(name), kind, PortDirection::Input, false, "An input"};
}
inline PortInfo opt(std::string name, PortKind kind = PortKind::Texture) {
    return {std::move(name), kind, PortDirection::Input, true, "An optional input"};
}
inline PortInfo out(std::string name, PortKind kind = PortKind::Texture) {
    return {std::move(name), kind, PortDirection::Output, false, "An output"};
}
inline PortInfo internal(std::string name, PortKind kind = PortKind::Texture) {
    return {std::move(name), kind, PortDirection::Internal, false, "An internal resource"};
}

inline PassType mockType(std::string name, std::vector<PortInfo> ports, Declare declare) {
    PassType type;
    type.name = std::move(name);
    type.description = "A pass for tests";
    type.ports = std::move(ports);
    type.make = [declare = std::move(declare)] { return std::make_unique<MockPass>(declare); };
    return type;
}

inline Desc image(std::uint32_t side = 16) { return Desc::texture2D(Format::RGBA16F, {side, side, 1}); }

inline Output output(std::string port, Desc desc = image()) {
    Output made;
    made.port = std::move(port);
    made.desc = desc;
    return made;
}

inline Use reads(std::string port, Access access = Access::Fetch) { return {std::move(port), access}; }
inline Use writes(std::string port, Access access = Access::Image) { return {std::move(port), access, true}; }

inline Step step(std::string name, std::vector<Use> uses, std::vector<ModuleUse> modules = {},
                 std::vector<std::string> shaders = {"mock.comp"}) {
    Step made;
    made.name = std::move(name);
    made.shaders = std::move(shaders);
    made.uses = std::move(uses);
    made.modules = std::move(modules);
    return made;
}

// A declaration of one step that reads all inputs that are connected and writes all outputs that are asked
// for, as most passes do.
inline Declare simple(std::vector<std::string> inputs, std::vector<std::string> outputs,
                      Causes depends = Causes::Frame) {
    return [=](const World&, const Inputs& in, const Demand& demand) {
        Declaration d;
        d.depends = depends;
        Step only = step("only", {});
        for (const std::string& input : inputs)
            if (in.connected(input)) only.uses.push_back(reads(input));
        for (const std::string& port : outputs)
            if (demand.reads(port)) {
                d.outputs.push_back(output(port));
                only.uses.push_back(writes(port));
            }
        d.steps.push_back(only);
        return d;
    };
}

inline Plan compileText(const std::string& text, const Registry& registry, const CompileOptions& options = {},
                        const World& world = {}) {
    const Graph graph = parseGraph(text, "g.json");
    return compile(graph, registry, makePasses(graph, registry), world, options);
}

inline std::vector<std::string> passNames(const Plan& plan) {
    std::vector<std::string> names;
    for (const PlanPass& pass : plan.passes) names.push_back(pass.name);
    return names;
}

inline std::vector<std::string> leftOutTexts(const Plan& plan) {
    std::vector<std::string> texts;
    for (const LeftOut& left : plan.leftOut) texts.push_back(left.what + ": " + left.why);
    return texts;
}

inline const PlanResource* resourceAt(const Plan& plan, const std::string& port) {
    for (const PlanResource& resource : plan.resources)
        if (resource.port.text() == port) return &resource;
    return nullptr;
}

inline const PlanPass* passAt(const Plan& plan, const std::string& name) {
    const auto found = std::find_if(plan.passes.begin(), plan.passes.end(),
                                    [&](const PlanPass& pass) { return pass.name == name; });
    return found == plan.passes.end() ? nullptr : &*found;
}

} // namespace kestrel::test
