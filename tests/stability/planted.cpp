// Passes that are wrong on purpose, each in one way that a stress case must find (tests/cli/stress_test.py),
// or the check of what leaving out changes (planted_leaving_out_test.cpp).
#include "execute/commands.h"
#include "graph/registry.h"
#include "plugin/plugin.h"
#include <chrono>
#include <csignal>
#include <thread>

namespace {

using namespace kestrel;

// A picture from the viewing depth, by one shader.
class FromDepth : public Pass {
public:
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand&) const override {
        const Desc& depth = inputs["view_depth"].desc;
        Declaration declaration;
        declaration.outputs.push_back(
            {.port = "result", .desc = Desc::texture2D(Format::R32F, depth.extent, depth.view)});
        declaration.steps.push_back({.name = "make",
                                     .run = [this, world](Commands& commands) { make(commands, world); },
                                     .shaders = {"planted/from_depth.comp"},
                                     .defines = {{shader(), "1"}},
                                     .uses = {{.port = "view_depth", .access = Access::Image},
                                              {.port = "result", .access = Access::Image, .write = true}}});
        declaration.depends = Causes::Camera | Causes::Cut | Causes::Size;
        return declaration;
    }

protected:
    template<class T>
    static PassType typeOf(const char* name, const char* description) {
        return Describe<T>(name, description)
            .input("view_depth", PortKind::Texture, "Distance along the view axis")
            .output("result", PortKind::Texture, "What is made of it");
    }
    [[nodiscard]] virtual const char* shader() const { return "COPY"; }
    virtual void make(Commands& commands, const World&) const {
        commands.dispatchOver(commands.desc("result").extent);
    }
};

class DividesByFar final : public FromDepth {
public:
    static PassType type() {
        return typeOf<DividesByFar>("DividesByFar", "Depth over that of the far plane");
    }
    [[nodiscard]] const char* shader() const override { return "DIVIDES_BY_FAR"; }
};

class FixedEpsilon final : public FromDepth {
public:
    static PassType type() {
        return typeOf<FixedEpsilon>("FixedEpsilon",
                                    "Where neighbours are nearer to each other than 0.05 units");
    }
    [[nodiscard]] const char* shader() const override { return "FIXED_EPSILON"; }
};

class Hangs final : public FromDepth {
public:
    static PassType type() { return typeOf<Hangs>("Hangs", "Never ends in a frame one pixel wide"); }
    void make(Commands& commands, const World& world) const override {
        while (world.size.width == 1) std::this_thread::sleep_for(std::chrono::seconds(1));
        FromDepth::make(commands, world);
    }
};

class Crashes final : public FromDepth {
public:
    static PassType type() { return typeOf<Crashes>("Crashes", "Ends the process where the scene is empty"); }
    void make(Commands& commands, const World& world) const override {
        if (world.facts.triangles == 0) static_cast<void>(std::raise(SIGSEGV));
        FromDepth::make(commands, world);
    }
};

// It reads the depth of every scene, and says that it needs none of one without blended materials.
class ClaimsNoNeed final : public FromDepth {
public:
    static PassType type() {
        return typeOf<ClaimsNoNeed>("ClaimsNoNeed", "Where something is, if something is blended");
    }
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override {
        Declaration declaration = FromDepth::declare(world, inputs, demand);
        if (world.facts.hasBlend) return declaration;
        declaration.steps.clear();
        declaration.outputs.front().constant = glm::vec4(0);
        declaration.leftOut.push_back({"depth", "no material is blended"});
        return declaration;
    }
};

// The nearest of the first eight fragments of each pixel; those that come later are dropped.
class DropsFragments final : public Pass {
public:
    static PassType type() {
        return Describe<DropsFragments>("DropsFragments", "The nearest fragment, of the first eight")
            .input("view_depth", PortKind::Texture, "Whose view is taken")
            .output("result", PortKind::Texture, "Reversed depth")
            .internal("counts", PortKind::Texture, "Fragments of each pixel")
            .internal("nearest", PortKind::Texture, "Bits of the greatest reversed depth");
    }
    [[nodiscard]] Declaration declare(const World&, const Inputs& inputs, const Demand&) const override {
        const Desc& depth = inputs["view_depth"].desc;
        Declaration declaration;
        declaration.outputs.push_back(
            {.port = "result", .desc = Desc::texture2D(Format::R32F, depth.extent, depth.view)});
        for (const char* port : {"counts", "nearest"})
            declaration.outputs.push_back({.port = port,
                                           .desc = Desc::texture2D(Format::R32UI, depth.extent, depth.view),
                                           .clear = glm::vec4(0)});
        const Extent extent = depth.extent;
        declaration.steps.push_back(
            {.name = "draw",
             .run =
                 [extent](Commands& commands) {
                     DrawState state = DrawState::overwrite();
                     state.viewport = glm::uvec2(extent.width, extent.height);
                     commands.drawScene(state, {TriangleClass::Opaque, TriangleClass::OpaqueDoubleSided});
                 },
             .shaders = {"planted/fragments.vert", "planted/fragments.frag"},
             .uses = {{.port = "counts", .access = Access::Image, .write = true},
                      {.port = "nearest", .access = Access::Image, .write = true}}});
        declaration.steps.push_back({.name = "resolve",
                                     .run = [extent](Commands& commands) { commands.dispatchOver(extent); },
                                     .shaders = {"planted/resolve.comp"},
                                     .uses = {{.port = "nearest", .access = Access::Image},
                                              {.port = "result", .access = Access::Image, .write = true}}});
        declaration.depends =
            Causes::Camera | Causes::Cut | Causes::Geometry | Causes::Transforms | Causes::Size;
        return declaration;
    }
};

} // namespace

KESTREL_PLUGIN {
    for (const PassType& type : {DividesByFar::type(), FixedEpsilon::type(), Hangs::type(), Crashes::type(),
                                 DropsFragments::type(), ClaimsNoNeed::type()})
        registry.add(type);
}
