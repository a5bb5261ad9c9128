// Puts the parts of a picture together: what effects computed without the surface's colour, and the colour.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class Composite : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    glm::vec3 ambient{0};

private:
    void compose(Commands& commands) const;
};

} // namespace kestrel
