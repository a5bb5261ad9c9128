#include "execute/finite.h"
#include <cmath>
#include <fmt/format.h>

namespace kestrel {

std::optional<BadValue> firstBadValue(const Image& image, double minimum, double maximum) {
    const auto good = [&](float value) {
        return std::isfinite(value) && value >= minimum && value <= maximum;
    };
    for (size_t i = 0; i < image.values.size(); ++i) {
        const float value = image.values[i];
        if (good(value)) continue;
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
        for (size_t rest = i; rest < image.values.size(); ++rest)
            bad.count += good(image.values[rest]) ? 0 : 1;
        return bad;
    }
    return std::nullopt;
}

std::string BadOutput::text() const {
    const std::string place = buffer ? fmt::format("element {}", first.x)
                                     : fmt::format("pixel ({}, {}){}", first.x, first.y,
                                                   layer >= 0 ? fmt::format(" of layer {}", layer) : "");
    return fmt::format("pass '{}', port '{}', {}, channel {}: {} is {}; {} of its values {}", pass, port,
                       place, first.channel, first.value, first.what, first.count,
                       first.count == 1 ? "is bad" : "are bad");
}

} // namespace kestrel
