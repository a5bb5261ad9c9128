// Passes that fail, each in one of the calls that Kestrel makes.
#include "execute/commands.h"
#include "graph/registry.h"
#include "plugin/plugin.h"
#include <stdexcept>

namespace {

using namespace kestrel;

// Fills its picture; what goes wrong, the derived classes say.
class Fill : public Pass {
public:
    int amount = 0;
    [[nodiscard]] Declaration declare(const World& world, const Inputs&, const Demand&) const override {
        Declaration declaration;
        declaration.outputs.push_back({.port = "result", .desc = Desc::texture2D(Format::R32F, world.size)});
        declaration.steps.push_back({.name = "fill",
                                     .run = [this](Commands& commands) { fill(commands); },
                                     .shaders = {shader()},
                                     .uses = {{.port = "result", .access = Access::Image, .write = true}}});
        return declaration;
    }
    virtual void fill(Commands& commands) const { commands.dispatchOver(commands.desc("result").extent); }
    [[nodiscard]] virtual const char* shader() const { return "faults/fill.comp"; }
};

class ThrowsInDeclare final : public Fill {
    [[nodiscard]] Declaration declare(const World&, const Inputs&, const Demand&) const override {
        throw std::runtime_error("nothing to declare");
    }
};

class ThrowsInStep final : public Fill {
    void fill(Commands&) const override { throw 7; }
};

class ThrowsInDestruction final : public Fill {
public:
    ThrowsInDestruction() = default;
    ThrowsInDestruction(const ThrowsInDestruction&) = delete;
    ThrowsInDestruction& operator=(const ThrowsInDestruction&) = delete;
    ~ThrowsInDestruction() override {
        if (amount == 0) return; // as the one is from which the defaults are taken
        const auto fail = [] { throw std::runtime_error("cannot let go"); };
        fail();
    }
};

class BrokenShader final : public Fill {
    [[nodiscard]] const char* shader() const override { return "faults/broken.comp"; }
};

template<class T>
PassType typeOf(const char* name) {
    return Describe<T>(name, "A pass that fails")
        .output("result", PortKind::Texture, "A picture")
        .number("amount", static_cast<int T::*>(&Fill::amount), 0, 10, "", "How much");
}

} // namespace

KESTREL_PLUGIN {
    registry.add(typeOf<Fill>("Fill"));
    registry.add(typeOf<ThrowsInDeclare>("ThrowsInDeclare"));
    registry.add(typeOf<ThrowsInStep>("ThrowsInStep"));
    registry.add(typeOf<ThrowsInDestruction>("ThrowsInDestruction"));
    registry.add(typeOf<BrokenShader>("BrokenShader"));
    PassType construction = typeOf<Fill>("ThrowsInConstruction");
    construction.make = []() -> std::unique_ptr<Pass> { throw std::runtime_error("out of bricks"); };
    registry.add(construction);
    PassType property = typeOf<Fill>("ThrowsInProperty");
    property.properties.front().set = [](Pass&, const Value&) { throw std::runtime_error("not that much"); };
    registry.add(property);
}
