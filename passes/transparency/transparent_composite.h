// Blended materials in exact order over an opaque picture: as exact as the layers that it is given. Those of
// ABuffer hold everything; of DepthPeeling and KBuffer only the nearest.
//
// glTF 2.0, 3.9.4: a surface of colour c and alpha a leaves a c + (1 - a) b of what is behind it, b. Surfaces
// are lit by the module `radiance` as hits of rays are, whatever stands before them; that light passes
// through them unweakened or not at all is a matter of the shadow maps, for which blended materials are
// masked.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class TransparentComposite final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    glm::vec3 ambient{0};
    float cutoff = 0;

private:
    void composite(Commands& commands) const;
};

} // namespace kestrel
