#include "plugin/plugin.h"

namespace {

class Good final : public kestrel::Pass {
public:
    int amount = 3;
    kestrel::Declaration declare(const kestrel::World&, const kestrel::Inputs&,
                                 const kestrel::Demand&) const override {
        return {};
    }
    void execute(const kestrel::Step&, kestrel::Commands&) override {}
};

} // namespace

KESTREL_PLUGIN {
    registry.add(kestrel::Describe<Good>("Good", "A pass of a plugin")
                     .output("result", kestrel::PortKind::Texture, "An image")
                     .number("amount", &Good::amount, 0, 10, "", "How much"));
}
