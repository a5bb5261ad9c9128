// A graph on a scene, frame after frame: facts, compilation, execution and time in one place. Tests, the
// command line, sweeps and the editor all render through it.
#pragma once
#include "execute/executor.h"
#include "execute/property_files.h"
#include "graph/plan.h"
#include "image/image.h"
#include "scene/facts.h"
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace kestrel {

class GpuScene;

struct RenderOptions {
    Extent size{640, 360, 1};
    std::uint32_t seed = 0;
    std::string camera; // empty: the graph's, else Scene::camera
    bool keepAll = false;
    bool shareMemory = true;
    bool timing = false; // times every step; waits for the GPU around each where the clock needs it
    std::optional<gl::StepClock::Kind> clock; // that times steps; absent: what measures the work here
    bool finishFrames = false;      // waits for the GPU at the end of each frame, so that its time is true
    bool checkFinite = false;       // an Error (MeasureFailed) names the bad outputs of every pass of a frame
    bool keepBad = false;           // with checkFinite: FrameRecord::bad holds them, and there is no error
    bool countIterations = false;   // an Error (MeasureFailed) names loops that some driver would cut short
    std::optional<double> timeStep; // seconds of the scene from frame to frame; absent: 1 / Scene::frameRate
    std::vector<PortRef> previews;  // ports to make and keep readable besides the graph's outputs
    std::function<void(const std::string& what, double fraction)> progress; // of long work in one step
};

// What one frame did.
struct FrameRecord {
    std::uint32_t index = 0;
    double ms = 0; // wall clock; until the GPU was done with timing or finishFrames on
    Causes events = Causes::None;
    std::vector<StepSample> samples;                             // with timing on
    std::map<std::string, std::map<std::string, double>> values; // what passes report: pass -> key -> value
    int recompiled = 0;                                          // after overflows
    std::vector<BadOutput> bad;                                  // with keepBad on
};

class Renderer {
public:
    // On the current GL context, whose capabilities are given. Throws InputError with everything that is
    // wrong with the graph, its shaders or the camera's name. The registry must outlive the renderer.
    Renderer(Graph graph, const Registry& registry, Scene scene, const Capabilities& capabilities,
             RenderOptions options = {});
    ~Renderer();

    // Renders the next frame. An animated scene begins at Scene::startTime, goes on by timeStep() a frame and
    // starts again at its end.
    // Throws InputError naming pass, need and limit if a pass overflows again and again.
    const FrameRecord& frame();
    [[nodiscard]] const FrameRecord& last() const { return record_; }

    // The content of an output, a preview, or of any port that the plan holds in memory of its own: a
    // texture's layer and level as floats, row 0 at the top. Throws InputError as heldResource() does.
    [[nodiscard]] Image read(const PortRef& port, int layer = 0, int mip = 0);
    [[nodiscard]] std::vector<std::byte> readBytes(const PortRef& port);
    // What it is. Throws InputError if it is not held.
    [[nodiscard]] const Desc& desc(const PortRef& port) const;

    // Changes. Each takes effect with the next frame; if it is refused (InputError), all stays as it was.
    void set(const std::string& setting); // as --set: a property, or an edge
    void setGraph(Graph graph);
    void setScene(Scene scene);
    void setSize(Extent size);
    void setSeed(std::uint32_t seed) { options_.seed = seed; }
    void setCamera(const std::string& name);
    void setFreeCamera(const std::optional<CameraState>& camera) { freeCamera_ = camera; }
    void setPreviews(std::vector<PortRef> previews);
    void setTiming(bool timing);
    void setTime(double seconds);                     // jumps there with the next frame
    void setPaused(bool paused) { paused_ = paused; } // the time stands still
    // Seconds of the scene from frame to frame, at least 0; absent: 1 / Scene::frameRate.
    void setTimeStep(std::optional<double> seconds) { options_.timeStep = seconds; }
    void restart(); // frame index 0, the scene's first time, nothing kept
    // The same pictures as after restart(), sooner: what is made of the scene alone (hierarchies, maps)
    // stays.
    void rewind();
    // Compiles anew if a shader file, or a file that a property names (of unit "file"), changed since it was
    // read; true if so. With an error in it the plan before stays and the InputError is thrown, once a
    // change.
    bool reloadIfChanged();

    [[nodiscard]] const Graph& graph() const { return graph_; }
    [[nodiscard]] const Scene& scene() const { return scene_; }
    [[nodiscard]] const SceneFacts& facts() const { return facts_; }
    [[nodiscard]] const Plan& plan() const { return executor_->plan(); }
    [[nodiscard]] const RenderOptions& options() const { return options_; }
    [[nodiscard]] const Capabilities& capabilities() const { return capabilities_; }
    [[nodiscard]] Executor& executor() { return *executor_; }
    [[nodiscard]] std::string cameraName() const;
    [[nodiscard]] double timeStep() const { return options_.timeStep.value_or(1 / scene_.frameRate); }
    [[nodiscard]] double time() const { return time_; } // of the last frame, seconds of the scene
    [[nodiscard]] std::uint32_t nextFrame() const { return index_; }
    [[nodiscard]] double compileMs() const { return compileMs_; } // of the last compilation, without shaders

private:
    void compileGraph(const Graph& graph);
    int runFrame(const FrameScene& frame, Causes events);
    void takeTime();
    void takeGeometry();
    void dropGrowth(const Graph& next);
    [[nodiscard]] FrameInfo frameInfo() const;
    [[nodiscard]] bool moves() const;

    Graph graph_;
    const Registry& registry_;
    Scene scene_;
    Capabilities capabilities_;
    RenderOptions options_;
    SceneFacts facts_;
    PassSet passes_;
    std::map<std::string, Growth> grown_; // by pass
    // What properties name, as it was before it was read last: of this graph, and of one that was refused.
    PropertyFiles files_;
    std::unique_ptr<GpuScene> gpu_;
    std::unique_ptr<Executor> executor_;

    std::optional<Flattener> flattener_; // of scene_
    const Geometry* geometry_ = nullptr; // the flattener's
    std::vector<LightState> lights_;
    int camera_ = 0;
    std::optional<CameraState> freeCamera_;
    std::uint32_t index_ = 0;
    double time_ = 0, geometryTime_ = 0, geometryPreviousTime_ = 0;
    bool paused_ = false, geometryMade_ = false;
    std::optional<double> jump_;
    bool jumped_ = false;
    std::optional<FrameConditions> lastConditions_; // none: the next frame is the first
    std::optional<FrameConditions> rewoundFrom_;    // what stands was made under
    FrameRecord record_;
    double compileMs_ = 0;
};

// The time of the frame `step` seconds after one at `time`, in a scene of `duration` seconds that starts
// again at its end.
double timeAfter(double time, double duration, double step = 1.0 / 60);

// The passes of a graph with its properties: pass objects of `before` of the same name and type are used
// again, with every property set anew.
PassSet reusePasses(const Graph& graph, const Registry& registry, const PassSet& before);

// The resource that holds a port's content under a plan. Throws InputError saying why there is none (left
// out, a shader module, unknown: with the near name), or that its memory serves others too, so that only a
// preview keeps what it holds.
int heldResource(const Plan& plan, const PortRef& port);

} // namespace kestrel
