// Blended materials in exact order by Embree on the CPU: what TransparentComposite is measured against.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class ReferenceTransparency final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    int samples = 64;
    bool shadows = true, emission = true, highlights = false;
    glm::vec3 ambient{0};
};

} // namespace kestrel
