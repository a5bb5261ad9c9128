// Looking for values that no output should hold.
#pragma once
#include "image/image.h"
#include <optional>
#include <string>

namespace kestrel {

struct BadValue {
    int x = 0, y = 0; // pixel, from the top left
    int channel = 0;
    float value = 0;
    std::string what; // "not a number", "infinite", "outside [0, 1]"
};

// The first value, row by row from the top, that is not a number, infinite, or outside [minimum, maximum].
std::optional<BadValue> firstBadValue(const Image& image, double minimum, double maximum);

} // namespace kestrel
