// The uniform blocks `<Port>View`: each image is read with the view of the frame in which it was made.
#pragma once
#include "draw/view_data.h"
#include "execute/commands.h"
#include "execute/step_bindings.h"
#include "gl/objects.h"
#include "shared/view.h"
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace kestrel {

// Where views look from in a frame, and where they did in the last one.
struct FrameViews {
    const FrameInfo& frame;
    ViewMoment now, before; // before: as now if there is no last frame
};

class ViewBlocks {
public:
    // Resources of the same port keep the frames they were made in.
    void adopt(const Plan& plan);
    // The producer is about to write the resource: what was made last becomes the previous content.
    void produced(int resource, const View& view, const FrameViews& frame);
    // The block for an image as it is read in `frame`. The motion of the camera that it tells is always that
    // up to `frame`.
    gl::Name block(const StepBindings::ViewSlot& view, const FrameViews& frame);

private:
    struct Made {
        std::optional<ViewFrame> now, before;
    };
    struct Key {
        int resource;
        bool previous;
        View view;
        bool operator==(const Key&) const = default;
    };
    struct Block {
        Key key;
        gl::Buffer buffer;
        shared::ViewData data{}; // what the buffer holds
    };
    Block& blockOf(const Key& key);
    std::map<std::string, Made> made_; // by port
    std::vector<Made*> resources_;
    std::vector<Block> blocks_; // few: one a view, image and frame that differ
};

} // namespace kestrel
