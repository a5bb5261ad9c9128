#include "execute/finite.h"
#include <cmath>
#include <fmt/format.h>

namespace kestrel {

std::optional<BadValue> firstBadValue(const Image& image, double minimum, double maximum) {
    for (size_t i = 0; i < image.values.size(); ++i) {
        const float value = image.values[i];
        const bool inside = value >= minimum && value <= maximum;
        if (std::isfinite(value) && inside) continue;
        const auto channels = static_cast<size_t>(image.channels);
        const auto width = static_cast<size_t>(image.width);
        BadValue bad;
        bad.channel = static_cast<int>(i % channels);
        bad.x = static_cast<int>(i / channels % width);
        bad.y = static_cast<int>(i / channels / width);
        bad.value = value;
        bad.what = std::isnan(value)       ? "not a number"
                   : !std::isfinite(value) ? "infinite"
                                           : fmt::format("outside [{}, {}]", minimum, maximum);
        return bad;
    }
    return std::nullopt;
}

} // namespace kestrel
