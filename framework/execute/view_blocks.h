// The uniform blocks `<Port>View`: each image is read with the view of the frame in which it was made.
#pragma once
#include "execute/commands.h"
#include "execute/step_bindings.h"
#include "gl/objects.h"
#include "shared/view.h"
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace kestrel {

class ViewBlocks {
public:
    // Resources of the same port keep the frames they were made in.
    void adopt(const Plan& plan);
    // The producer is about to write the resource: what was made last becomes the previous content.
    void produced(int resource, const FrameInfo& frame);
    // The block for an image as it is read in `frame`. The motion of the camera that it tells is always that
    // up to `frame`.
    gl::Name block(const StepBindings::ViewSlot& view, const FrameInfo& frame);

private:
    struct Made {
        std::optional<FrameInfo> now, before;
    };
    struct Block {
        gl::Buffer buffer;
        shared::ViewData data{}; // what the buffer holds
    };
    std::map<std::string, Made> made_; // by port
    std::vector<Made*> resources_;
    // Few: one a view, image and frame that differ.
    std::map<std::tuple<int, bool, int, int, int, bool>, Block> blocks_;
};

} // namespace kestrel
