// Light from infinitely far away, by direction: one colour, a gradient over the height, or an image.
#pragma once
#include "graph/registry.h"
#include "image/image.h"
#include <filesystem>

namespace kestrel {

class Environment : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    enum class Kind { Constant, Gradient, Picture };
    Kind kind = Kind::Gradient;
    glm::vec3 colour{1};
    glm::vec3 zenith{0.25f, 0.45f, 0.9f}, horizon{0.8f, 0.85f, 0.9f}, ground{0.12f, 0.11f, 0.1f};
    float intensity = 1;
    float rotation = 0;
    std::string file;

private:
    [[nodiscard]] Defines defines() const;
    void upload(Commands& commands) const;
};

} // namespace kestrel
