// The colour spaces and the colour difference of FLIP (Andersson et al. 2020, section 4.1).
#pragma once

namespace kestrel::detail {

struct Color {
    float x, y, z;
};

// Linear sRGB (D65) to the opponent space YCxCz, linear in light, in which the contrast sensitivity functions
// are given: Y in [-16, 100]; grey has Cx = Cz = 0. And back.
Color opponentFromRgb(Color rgb);
Color rgbFromOpponent(Color opponent);

// Linear sRGB in [0, 1] to CIELAB with the Hunt effect: chroma counts in proportion to lightness.
Color huntLabFromRgb(Color rgb);

// The distance HyAB (Abasi et al. 2020): city block in lightness, Euclidean in chroma.
float hyab(Color a, Color b);

// Error in [0, 1] from a HyAB distance: most of the range for the differences below the knee.
float colorError(float distance);

} // namespace kestrel::detail
