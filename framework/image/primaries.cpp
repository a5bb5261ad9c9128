#include "image/primaries.h"
#include "core/check.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

namespace kestrel::detail {
namespace {

// XYZ of a colour of this chromaticity whose X + Y + Z is 1: so nothing is divided by a y of 0.
glm::dvec3 direction(const glm::dvec2& xy) { return {xy.x, xy.y, 1 - xy.x - xy.y}; }

glm::dvec3 whiteXyz(const Primaries& primaries) { return direction(primaries.white) / primaries.white.y; }

// From RGB to XYZ such that (1, 1, 1) has the white's chromaticity and Y = 1.
std::optional<glm::dmat3> toXyz(const Primaries& primaries) {
    if (!(primaries.white.y > 1e-6)) return std::nullopt;
    const glm::dmat3 directions(direction(primaries.red), direction(primaries.green),
                                direction(primaries.blue));
    if (!(std::abs(glm::determinant(directions)) > 1e-6)) return std::nullopt;
    const glm::dvec3 weights = glm::inverse(directions) * whiteXyz(primaries);
    const glm::dmat3 matrix(directions[0] * weights.r, directions[1] * weights.g, directions[2] * weights.b);
    if (!(std::abs(glm::determinant(matrix)) > 1e-9)) return std::nullopt;
    return matrix;
}

// The adaptation of XYZ from one white to another.
glm::dmat3 bradford(const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dmat3 cones(0.8951, -0.7502, 0.0389, 0.2664, 1.7135, -0.0685, -0.1614, 0.0367, 1.0296);
    const glm::dvec3 scale = (cones * to) / (cones * from);
    const glm::dmat3 scaled(scale.x, 0, 0, 0, scale.y, 0, 0, 0, scale.z);
    return glm::inverse(cones) * scaled * cones;
}

} // namespace

bool alike(const Primaries& a, const Primaries& b) {
    const auto near = [](const glm::dvec2& p, const glm::dvec2& q) {
        return std::abs(p.x - q.x) < 0.00075 && std::abs(p.y - q.y) < 0.00075;
    };
    return near(a.red, b.red) && near(a.green, b.green) && near(a.blue, b.blue) && near(a.white, b.white);
}

std::string describe(const Primaries& primaries) {
    const auto text = [](const glm::dvec2& xy) { return fmt::format("({:.4g}, {:.4g})", xy.x, xy.y); };
    return fmt::format("red {}, green {}, blue {}, white {}", text(primaries.red), text(primaries.green),
                       text(primaries.blue), text(primaries.white));
}

std::optional<glm::dmat3> toRec709(const Primaries& primaries) {
    const std::optional<glm::dmat3> xyz = toXyz(primaries);
    if (!xyz) return std::nullopt;
    const glm::dmat3 back = glm::inverse(*toXyz(rec709));
    if (alike(primaries, cieXyz)) return back * *xyz;
    const glm::dmat3 matrix = back * bradford(whiteXyz(primaries), whiteXyz(rec709)) * *xyz;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            if (!std::isfinite(matrix[column][row])) return std::nullopt;
    return matrix;
}

void transformColours(Image& image, const glm::dmat3& matrix) {
    KESTREL_CHECK(image.channels == 3 || image.channels == 4);
    for (std::size_t at = 0; at < image.values.size(); at += static_cast<std::size_t>(image.channels)) {
        const glm::dvec3 colour(image.values[at], image.values[at + 1], image.values[at + 2]);
        const glm::dvec3 converted = matrix * colour;
        for (int channel = 0; channel < 3; ++channel)
            image.values[at + static_cast<std::size_t>(channel)] = static_cast<float>(converted[channel]);
    }
}

} // namespace kestrel::detail
