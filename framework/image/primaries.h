// The colours that red, green, blue and white of a picture stand for, and their conversion to those of
// Rec. 709.
#pragma once
#include "image/image.h"
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <optional>
#include <string>

namespace kestrel::detail {

// CIE 1931 x and y of each.
struct Primaries {
    glm::dvec2 red{0.64, 0.33};
    glm::dvec2 green{0.30, 0.60};
    glm::dvec2 blue{0.15, 0.06};
    glm::dvec2 white{0.3127, 0.3290};
    friend bool operator==(const Primaries&, const Primaries&) = default;
};
inline constexpr Primaries rec709;
// CIE X, Y and Z themselves in place of red, green and blue.
inline constexpr Primaries cieXyz{{1, 0}, {0, 1}, {0, 0}, {1.0 / 3, 1.0 / 3}};

// Whether both agree to three decimals, as many as most files write.
bool alike(const Primaries& a, const Primaries& b);

// "red (0.64, 0.33), green ...", for messages.
std::string describe(const Primaries& primaries);

// The matrix from linear RGB of these primaries to that of Rec. 709. White becomes white by the Bradford
// transform (Lam 1985; as in ICC.1:2022, annex E) - but X, Y and Z of `cieXyz` are taken as they are, since
// they state colours and no white. Nothing if the primaries span no colours.
std::optional<glm::dmat3> toRec709(const Primaries& primaries);

// Each pixel's first three values as a column behind the matrix; the image must have three or four channels.
void transformColours(Image& image, const glm::dmat3& matrix);

} // namespace kestrel::detail
