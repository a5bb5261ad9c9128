// From values to what a screen shows: exposure, channels, ranges, heat maps. No GL.
#pragma once
#include "image/image.h"
#include <cstdint>
#include <string>
#include <vector>

namespace kestrel::edit {

struct Development {
    enum class Mode : std::uint8_t {
        Colour,  // red, green, blue as linear light
        Display, // as sRGB code values
        Red,
        Green,
        Blue,
        Alpha, // one channel as a grey
        Heat   // luminance, or the single channel, through a colour map
    };
    Mode mode = Mode::Colour;
    float exposure = 0;      // stops; not of Display
    float low = 0, high = 1; // what becomes black and white
    bool marks = true; // not a number is magenta, infinity cyan, negative yellow where it cannot be seen else
};
inline constexpr const char* developmentNames[] = {"colour", "display", "red", "green",
                                                   "blue",   "alpha",   "heat"};

// RGBA8, rows from top to bottom, with sRGB code values.
std::vector<std::uint8_t> develop(const Image& image, const Development& development);

// The range that holds all but the outermost hundredth of the finite values at either end; [0, 1] if there is
// none. Of colours the lower end is 0.
void automaticRange(const Image& image, Development& development);

// The values of one pixel as text, one line a channel; a row of the values of its neighbours (3x3) of one
// channel.
std::string pixelText(const Image& image, int x, int y);
std::string neighboursText(const Image& image, int x, int y, int channel);

} // namespace kestrel::edit
