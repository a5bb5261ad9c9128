#include "graph/pass.h"
#include "core/check.h"

namespace kestrel {

Extent World::extentOf(const View& view) const {
    const auto along = [&view](std::uint32_t frame) {
        const auto divisor = static_cast<std::uint32_t>(view.divisor);
        return (frame + 2 * static_cast<std::uint32_t>(view.guard) + divisor - 1) / divisor;
    };
    KESTREL_CHECK(view.divisor > 0 && view.guard >= 0);
    const Extent whole = sizeOf(view);
    return {along(whole.width), along(whole.height), 1};
}

const Inputs::Input& Inputs::operator[](std::string_view port) const {
    const auto found = inputs_.find(port);
    KESTREL_CHECK(found != inputs_.end());
    return found->second;
}

Bits Demand::requests(std::string_view port) const {
    if (all_) return ~Bits{0};
    const auto found = ports_.find(port);
    return found == ports_.end() ? Bits{0} : found->second;
}

void Demand::add(std::string port, Bits requests) { ports_[std::move(port)] |= requests; }

void Pass::execute(const Step& step, Commands& commands) {
    KESTREL_CHECK(step.run); // the step has nothing to run
    step.run(*this, commands);
}

} // namespace kestrel
