#include "apart.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel::edit {
namespace {

size_t differingPixels(const Image& a, const Image& b) {
    size_t count = 0;
    const auto channels = static_cast<size_t>(a.channels);
    for (size_t i = 0; i < a.pixelCount(); ++i) {
        const auto differs = [&](size_t c) {
            const float x = a.values[i * channels + c], y = b.values[i * channels + c];
            return x != y && (x == x || y == y); // one that is no number equals itself here
        };
        for (size_t c = 0; c < channels; ++c)
            if (differs(c)) {
                ++count;
                break;
            }
    }
    return count;
}

} // namespace

std::string toggleApart(Session& session, const PortRef& resource, const PortRef& seen) {
    std::string why;
    if (!session.renderAgain()) return "nothing can be rendered";
    const Image before = session.read(seen, why);
    const auto found = std::find(session.apart.begin(), session.apart.end(), resource);
    const bool alone = found == session.apart.end();
    if (alone)
        session.apart.push_back(resource);
    else
        session.apart.erase(found);
    session.follow();
    if (!session.renderAgain()) return "nothing can be rendered";
    const Image after = session.read(seen, why);
    const std::string what = alone ? fmt::format("{} has memory of its own", resource.text())
                                   : fmt::format("{} shares its memory again", resource.text());
    if (before.empty() || !before.sameSize(after)) return what;
    if (const size_t differ = differingPixels(before, after); differ > 0)
        return fmt::format("{}: {} of {} pixels of {} are others, so that sharing is to blame", what, differ,
                           after.pixelCount(), seen.text());
    return fmt::format("{}: {} is the same to the bit, so that sharing is not to blame", what, seen.text());
}

} // namespace kestrel::edit
