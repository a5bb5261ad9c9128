// Where each resource of a step goes in its program: worked out once a compilation, so that a frame only
// binds.
#pragma once
#include "execute/programs.h"
#include "graph/plan.h"
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace kestrel {

struct StepBindings {
    struct Slot {
        gl::Program::Slot where;
        int binding = 0; // index into PlanStep::bindings
    };
    struct ViewSlot {
        unsigned int unit = 0;
        View view;
        Extent extent;     // of the image, guard band included
        int resource = -1; // that the image is; -1: only the view is known
        bool previous = false;
    };
    std::vector<Slot> slots;
    std::vector<ViewSlot> views;                   // `<Port>View` blocks
    std::optional<unsigned int> frame, iterations; // the blocks Frame and Iterations
    bool scene = false;                            // the program has names that the scene binds
    std::vector<int> colour;                       // bindings, in the order of attachment numbers
    int depth = -1;
    bool restrictsMips = false;
};

// Throws InputError that names pass, step, program and slot for everything in the program that nothing
// binds, and for a slot of another kind than the use says. `boundByScene` tells the scene's reserved names.
StepBindings resolveBindings(const Plan& plan, int step, const Programs::Entry* program,
                             const std::function<bool(std::string_view)>& boundByScene);

} // namespace kestrel
