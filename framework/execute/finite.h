// Looking for values that no output should hold.
#pragma once
#include "image/image.h"
#include <cstdint>
#include <optional>
#include <string>

namespace kestrel {

struct BadValue {
    int x = 0, y = 0; // pixel, from the top left
    int channel = 0;
    float value = 0;
    std::string what;        // "not a number", "infinite", "outside [0, 1]"
    std::uint64_t count = 0; // how many values of the image are bad, this one included
    friend bool operator==(const BadValue&, const BadValue&) = default;
};

// The first bad value of one port in one frame.
struct BadOutput {
    std::string pass, port;
    int layer = -1;      // of an array, a volume or a cube
    bool buffer = false; // then `x` counts elements
    BadValue first;
    // "pass 'a', port 'b', pixel (3, 1), channel 0: nan is not a number; 7 values of it are bad".
    [[nodiscard]] std::string text() const;
};

// The first value, row by row from the top, that is not a number, infinite, or outside [minimum, maximum].
std::optional<BadValue> firstBadValue(const Image& image, double minimum, double maximum);

} // namespace kestrel
