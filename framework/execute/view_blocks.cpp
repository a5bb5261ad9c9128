#include "execute/view_blocks.h"
#include <algorithm>
#include <span>

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

namespace {

ViewFrame viewFrame(const View& view, const FrameViews& frame) {
    return {frame.frame.size, frame.frame.index, cameraOf(view, frame.now), cameraOf(view, frame.before)};
}

} // namespace

void ViewBlocks::produced(int resource, const View& view, const FrameViews& frame) {
    Made& made = *resources_.at(static_cast<size_t>(resource));
    // A frame that is begun again makes the same content once more.
    if (made.now && made.now->index != frame.frame.index) made.before = made.now;
    made.now = viewFrame(view, frame);
}

ViewBlocks::Block& ViewBlocks::blockOf(const Key& key) {
    for (Block& block : blocks_)
        if (block.key == key) return block;
    return blocks_.emplace_back(Block{key, {}, {}});
}

gl::Name ViewBlocks::block(const StepBindings::ViewSlot& view, const FrameViews& frame) {
    ViewFrame madeIn = viewFrame(view.view, frame);
    if (view.resource >= 0) {
        const Made& made = *resources_.at(static_cast<size_t>(view.resource));
        if (const std::optional<ViewFrame>& known = view.previous ? made.before : made.now; known) {
            const CameraState before = madeIn.previousCamera;
            madeIn = *known;
            madeIn.previousCamera = before;
        }
    }
    const shared::ViewData data = viewData(view.view, view.extent, madeIn);

    Block& block = blockOf({view.resource, view.previous, view.view});
    const auto bytes = std::as_bytes(std::span(&data, 1)), before = std::as_bytes(std::span(&block.data, 1));
    if (!block.buffer || !std::equal(bytes.begin(), bytes.end(), before.begin())) {
        if (!block.buffer) block.buffer = gl::Buffer(sizeof(shared::ViewData), "View");
        block.data = data;
        block.buffer.upload(bytes);
    }
    return block.buffer.name();
}

} // namespace kestrel
