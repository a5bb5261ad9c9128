#include "execute/view_blocks.h"
#include "draw/view_data.h"
#include <cstring>

namespace kestrel {

void ViewBlocks::adopt(const Plan& plan) {
    std::map<std::string, Made> made;
    resources_.clear();
    for (const PlanResource& resource : plan.resources) {
        const std::string port = resource.port.text();
        const auto old = made_.find(port);
        const auto place = made.try_emplace(port, old != made_.end() ? old->second : Made{}).first;
        resources_.push_back(&place->second); // nodes of a map stay where they are, also when it is moved
    }
    made_ = std::move(made);
    blocks_.clear();
}

void ViewBlocks::produced(int resource, const FrameInfo& frame) {
    Made& made = *resources_.at(static_cast<size_t>(resource));
    // A frame that is begun again makes the same content once more.
    if (made.now && made.now->index != frame.index) made.before = made.now;
    made.now = frame;
}

gl::Name ViewBlocks::block(const StepBindings::ViewSlot& view, const FrameInfo& frame) {
    FrameInfo madeIn = frame;
    if (view.resource >= 0) {
        const Made& made = *resources_.at(static_cast<size_t>(view.resource));
        if (const std::optional<FrameInfo>& known = view.previous ? made.before : made.now; known)
            madeIn = *known;
    }
    madeIn.previousCameraState = frame.previousCameraState;
    const shared::ViewData data = viewData(view.view, view.extent, madeIn);

    Block& block = blocks_[{view.resource, view.previous, view.view.camera, view.view.divisor,
                            view.view.guard, view.view.jitter}];
    if (!block.buffer || std::memcmp(&block.data, &data, sizeof(data)) != 0) {
        if (!block.buffer) block.buffer = gl::Buffer(sizeof(shared::ViewData), "View");
        block.data = data;
        block.buffer.upload(std::as_bytes(std::span(&data, 1)));
    }
    return block.buffer.name();
}

} // namespace kestrel
