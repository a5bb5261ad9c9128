// From scene-referred light to display-referred values.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class ToneMap final : public Pass {
public:
    enum class Operator { Linear, Reinhard, Aces };

    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    Operator curve = Operator::Aces;
    float exposure = 0;
    bool autoExposure = false;
    float key = 0.18f;
    float adaptation = 16;
    bool encode = true;

private:
    void declareMetering(Declaration& declaration, const Desc& colour) const;
    void meter(Commands& commands) const;
    void adapt(Commands& commands) const;
    void report(Commands& commands) const;
    void map(Commands& commands) const;
};

} // namespace kestrel
