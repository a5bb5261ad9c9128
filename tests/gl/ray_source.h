// Rays that a test chooses, as a pass.
#pragma once
#include "execute/commands.h"
#include "graph/registry.h"
#include "shared/ray.h"
#include <vector>

namespace kestrel::test {

// Hands a list of rays to whoever asks.
class RaySource final : public Pass {
public:
    static PassType type() {
        return Describe<RaySource>("RaySource", "Rays of a test")
            .output("rays", PortKind::Buffer, "Ray records")
            .carries(content::elements("RayRecord"));
    }
    static inline std::vector<shared::RayRecord> rays;
    static inline bool texels = false; // as those who trace many rays an invocation read them
    [[nodiscard]] Declaration declare(const World&, const Inputs&, const Demand&) const override {
        Declaration declaration;
        declaration.outputs = {{.port = "rays",
                                .desc = Desc::buffer(rays.size() * sizeof(shared::RayRecord),
                                                     texels ? Format::RGBA32UI : Format::None)}};
        declaration.steps = {
            {.name = "upload", .uses = {{.port = "rays", .access = Access::Copy, .write = true}}}};
        declaration.depends = Causes::Frame;
        return declaration;
    }
    void execute(const Step&, Commands& commands) override { commands.upload("rays", rays); }
};

} // namespace kestrel::test
