#include "plugin/plugin.h"

#ifndef VALUE
#define VALUE 1 // what the code makes, so that one build is told from another
#endif

namespace {

class Good final : public kestrel::Pass {
public:
    int amount = 3;
    kestrel::Declaration declare(const kestrel::World&, const kestrel::Inputs&,
                                 const kestrel::Demand&) const override {
        kestrel::Declaration declaration;
        declaration.outputs.push_back(
            {.port = "result", .desc = kestrel::Desc::texture2D(kestrel::Format::R32F, {4, 4, 1})});
        declaration.outputs.back().constant = glm::vec4(VALUE);
        return declaration;
    }
    void execute(const kestrel::Step&, kestrel::Commands&) override {}
};

} // namespace

KESTREL_PLUGIN {
    registry.add(kestrel::Describe<Good>("Good", "A pass of a plugin")
                     .output("result", kestrel::PortKind::Texture, "An image")
                     .number("amount", &Good::amount, 0, 10, "", "How much"));
}
