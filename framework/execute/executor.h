// Runs a plan on the current GL context, frame by frame.
#pragma once
#include "execute/commands_impl.h"
#include "execute/programs.h"
#include "execute/resources.h"
#include "execute/schedule.h"
#include "execute/view_blocks.h"
#include "gl/timer.h"
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace kestrel {

// One execution of one step.
struct StepSample {
    std::string pass, type, step, group; // group: what the time counts as; the pass's name if it says nothing
    std::uint32_t frame = 0;
    double ms = 0;
    bool preview = false; // it ran for previews alone
};

struct ExecutorOptions {
    bool timing = false; // a clock around every step; waits for the GPU at each where the clock needs it
    std::optional<gl::StepClock::Kind> clock; // absent: what measures the work on this renderer
    bool checkFinite = false;                 // scans what each pass wrote: FrameReport::bad
    // Counts the iterations of shaders' loops from the next plan on; an Error of MeasureFailed names the
    // steps that make more than a driver surely runs (shader/iterations.h).
    bool countIterations = false;
};

class Executor {
public:
    Executor(const Capabilities& capabilities, std::vector<std::filesystem::path> shaderFolders);
    ~Executor();

    // Takes a plan over: makes its programs and resources. Resources and histories with the same ports and
    // descriptor keep their content; a pass that is as it was, down to the text of its programs, `stateText`
    // (its property values, say), inputs and resources, does not run again for the new plan's sake. Throws
    // InputError with the problems of all programs (the old plan stays), MachineError for what the device
    // cannot hold.
    using StateText = std::function<std::string(const PlanPass&)>;
    void adopt(std::shared_ptr<const Plan> next, const StateText& stateText = {});

    // Runs one frame. False: a pass overflowed (see report); compile with CompileOptions::grown, adopt, and
    // call again with the same frame. What ran before the overflow and has kept its results does not run
    // again.
    bool run(const FrameScene& frame, Causes events);
    // After run() said false: the frame is given up. What did not run stays due.
    void abandonFrame();
    // The next frame is a first one but for what depends on the scene alone, which stays as it is.
    void rewind();

    [[nodiscard]] const FrameReport& report() const { return report_; }
    [[nodiscard]] FrameReport& report() { return report_; }
    [[nodiscard]] const std::vector<StepSample>& samples() const { return samples_; } // of the last frame
    [[nodiscard]] const std::vector<PassState>& states() const { return states_; }
    [[nodiscard]] const Plan& plan() const;
    [[nodiscard]] Resources& resources() { return resources_; }
    [[nodiscard]] ShaderLibrary& shaders() { return library_; }
    [[nodiscard]] const Programs& programs() const { return programs_; }
    // Which clock the samples come from (gl::StepClock::name).
    [[nodiscard]] std::string clockName() const { return std::string(makeClock().name()); }

    ExecutorOptions options;
    // Where an output's range is known (see finite.h): the table of its type.
    const Registry* registry = nullptr;

private:
    [[nodiscard]] gl::StepClock makeClock() const {
        return options.clock ? gl::StepClock(*options.clock) : gl::StepClock(capabilities_);
    }

    struct Kept { // what is compared between the plans
        std::string signature, state;
    };
    static constexpr int iterationsStride = 256; // bytes: no device asks for a coarser alignment of ranges

    static std::string signature(const Plan& plan, const PlanPass& pass, const Programs& programs);
    void keepStates(const Plan& next, const Programs& programs, const StateText& stateText);
    void beginFrame(const FrameScene& frame);
    bool runPass(int index, const FrameScene& frame);
    void runStep(int index, const FrameScene& frame);
    void swapHistories(const PlanPass& pass);
    void clearOutputs(const PlanPass& pass);
    // `target` becomes what the step draws into; its size is given back.
    std::optional<glm::uvec2> bind(int index, const FrameScene& frame, gl::Target& target);
    void bindSlot(const PlanBinding& binding, const gl::Program::Slot& slot);
    std::optional<glm::uvec2> bindTarget(const PlanStep& step, const StepBindings& bindings,
                                         gl::Target& target);
    // Before a step that reads single levels of a texture, and back after it.
    void restrictMips(const PlanStep& step, const StepBindings& bindings, bool restrict);
    // Reads the counters of the passes that ran since the last reading. False: an output was too small; what
    // used it is due again.
    bool countersFit();
    void collectSamples(std::uint32_t frameIndex);
    void checkIterations();
    void checkOutputs(const PlanPass& pass);

    Capabilities capabilities_;
    ShaderLibrary library_;
    Programs programs_;
    Resources resources_;
    gl::FramebufferCache framebuffers_;
    gl::SamplerCache samplers_;
    ViewBlocks views_;
    std::shared_ptr<const Plan> plan_;
    std::vector<StepBindings> bindings_;           // of each step
    std::vector<std::string> labels_;              // "pass 'a', step 'b'" of each step
    std::vector<PassState> states_;                // of each pass
    std::map<std::string, Kept> kept_;             // by pass
    std::vector<std::vector<int>> countersBehind_; // of each pass: those with counters whose results reach it
    std::vector<int> uncounted_; // passes with counters that ran in this frame and were not read yet
    gl::Buffer counts_;          // where counters are gathered
    FrameReport report_;
    std::vector<StepSample> samples_;
    std::unique_ptr<gl::StepClock> clock_;
    gl::VertexArray noVertices_;
    gl::Buffer frameBlock_, iterations_;
    Causes lastEvents_ = Causes::None;
    bool unfinished_ = false; // the frame was left after an overflow
};

} // namespace kestrel
