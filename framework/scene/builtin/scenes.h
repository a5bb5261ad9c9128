// The makers of the built-in scenes, one file each. `Detail` is the one knob that they share.
#pragma once
#include "scene/scene.h"
#include <algorithm>
#include <cmath>

namespace kestrel::builtin {

// The detail of a built-in scene: a factor on its number of triangles.
class Detail {
public:
    explicit Detail(double factor)
        : factor_(factor) {}
    // Steps along one of the two directions of a surface: `base` times the root of the factor.
    [[nodiscard]] int steps(int base, int minimum) const {
        return std::max(minimum, static_cast<int>(std::lround(base * std::sqrt(factor_))));
    }
    // A number of things: `base` times the factor.
    [[nodiscard]] int count(int base, int minimum) const {
        return std::max(minimum, static_cast<int>(std::lround(base * factor_)));
    }
    [[nodiscard]] double factor() const { return factor_; }

private:
    double factor_;
};

Scene makeCornell(Detail detail);
Scene makeBlob(Detail detail);
Scene makeTower(Detail detail);
Scene makeHall(Detail detail);
Scene makeGrove(Detail detail);
Scene makeMorph(Detail detail);
Scene makeSkinned(Detail detail);
Scene makePool(Detail detail);
Scene makeLattice(Detail detail);

} // namespace kestrel::builtin
