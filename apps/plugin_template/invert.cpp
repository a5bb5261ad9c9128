// A whole pass in one file: the smallest thing that is still useful.
#include "execute/commands.h"
#include "graph/registry.h"
#include "plugin/plugin.h"

namespace {

using namespace kestrel;

class Invert final : public Pass {
public:
    // The table: everything that files, --set, the schema and the documentation say about the pass comes from
    // here.
    static PassType type() {
        return Describe<Invert>("Invert", "One minus the signal, scaled")
            .input("signal", PortKind::Texture, "Values in [0, 1]")
            .output("result", PortKind::Texture, "(1 - signal) times the scale")
            .number("scale", &Invert::scale, 0, 100, "", "Factor on the result");
    }

    // What it makes and which steps that takes. Pure: called several times, without a GPU.
    [[nodiscard]] Declaration declare(const World&, const Inputs& inputs, const Demand&) const override {
        const Inputs::Input& signal = inputs["signal"];
        Declaration declaration;
        Output result{.port = "result",
                      .desc = Desc::texture2D(Format::RGBA32F, signal.desc.extent, signal.desc.view)};
        if (signal.constant) { // one minus a constant is a constant: no step, and readers know
            result.constant = (1.0f - *signal.constant) * scale;
            declaration.outputs.push_back(std::move(result));
            declaration.leftOut.push_back({"inverting", "the signal is the same everywhere"});
            return declaration;
        }
        declaration.outputs.push_back(std::move(result));
        declaration.steps.push_back({.name = "invert",
                                     .shaders = {"plugin_template/invert.comp"},
                                     .uses = {{.port = "signal", .access = Access::Fetch},
                                              {.port = "result", .access = Access::Image, .write = true}}});
        declaration.depends = Causes::Properties;
        return declaration;
    }

    // One step on the GPU. Resources, barriers and clocks are set around it.
    void execute(const Step&, Commands& commands) override {
        commands.set("scale", scale);
        commands.dispatchOver(commands.desc("result").extent);
    }

private:
    float scale = 1;
};

} // namespace

KESTREL_PLUGIN { registry.add(Invert::type()); }
