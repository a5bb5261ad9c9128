#include "execute/renderer.h"
#include "core/check.h"
#include "core/files.h"
#include "draw/gpu_scene.h"
#include "gl/context.h"
#include "gl/lost_context.h"
#include "graph/value_text.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <utility>

namespace kestrel {

namespace {

// A pass may find only after growing once that it needs more still; a port that grows more often than that in
// one frame never ends.
constexpr int maxGrowths = 8;

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

std::vector<std::filesystem::path> shaderFolders(const Registry& registry) {
    std::vector<std::filesystem::path> folders{shareFolder() / "shaders"};
    folders.insert(folders.end(), registry.shaderFolders.begin(), registry.shaderFolders.end());
    return folders;
}

void requireValid(const Graph& graph, const Registry& registry) {
    std::vector<Problem> problems = validate(graph, registry);
    if (!problems.empty()) throw InputError(std::move(problems));
}

} // namespace

double timeAfter(double time, double duration, double step) {
    const double next = time + step;
    return next <= duration ? next : duration > 0 ? std::fmod(next, duration) : 0;
}

PassSet reusePasses(const Graph& graph, const Registry& registry, const PassSet& before) {
    PassSet passes = makePasses(graph, registry);
    for (const GraphPass& pass : graph.passes) {
        const auto old = before.find(pass.name);
        const PassType* type = registry.find(pass.type);
        if (old == before.end() || type == nullptr) continue;
        const Pass& made = *passes.at(pass.name);
        if (old->second->typeInstance != made.typeInstance) continue;
        setProperties(*old->second, *type, pass);
        passes[pass.name] = old->second;
    }
    return passes;
}

Renderer::Renderer(Graph graph, const Registry& registry, Scene scene, const Capabilities& capabilities,
                   RenderOptions options)
    : graph_(std::move(graph))
    , registry_(registry)
    , scene_(std::move(scene))
    , capabilities_(capabilities)
    , options_(std::move(options)) {
    requireValid(graph_, registry_);
    camera_ = cameraIndex(scene_, options_.camera.empty() ? graph_.sceneSetup.cameraName : options_.camera);
    time_ = scene_.startTime;
    facts_ = gatherFacts(scene_);
    executor_ = std::make_unique<Executor>(capabilities_, shaderFolders(registry_));
    executor_->registry = &registry_;
    executor_->options = {.timing = options_.timing,
                          .clock = options_.clock,
                          .checkFinite = options_.checkFinite,
                          .countIterations = options_.countIterations};
    executor_->report().progress = options_.progress;
    compileGraph(graph_);
    gpu_ = std::make_unique<GpuScene>(scene_);
}

Renderer::~Renderer() = default;

// ---- compiling

void Renderer::compileGraph(const Graph& graph) {
    const World world{facts_, capabilities_, options_.size};
    const auto start = Clock::now();
    PassSet passes = reusePasses(graph, registry_, passes_);
    const PropertyFiles files = propertyFiles(passes, graph, registry_);
    for (const auto& [file, state] : files) files_.insert_or_assign(file, state);
    auto plan = std::make_shared<const Plan>(
        compile(graph, registry_, passes, world,
                {options_.keepAll, options_.shareMemory, options_.previews, grown_}));
    compileMs_ = millisecondsSince(start);
    executor_->adopt(std::move(plan), [&](const PlanPass& pass) {
        // Of another registration of the type it is another pass: its plugin was built anew.
        std::string text = fmt::format("{}\n", pass.instance->typeInstance);
        for (const PropertyInfo& property : registry_.find(pass.type)->properties) {
            text += property.name + "=" + jsonText(property.get(*pass.instance)) + "\n";
            if (const auto file = files.find(propertyFile(property, *pass.instance));
                file != files.end() && file->second)
                text += fmt::format("{} {}\n", file->second->bytes,
                                    file->second->modified.time_since_epoch().count());
        }
        return text;
    });
    passes_ = std::move(passes);
    files_ = files;
}

// Growth holds for a pass as it is: of another type or with other properties it may need less.
void Renderer::dropGrowth(const Graph& next) {
    std::erase_if(grown_, [&](const auto& item) {
        const GraphPass* before = graph_.find(item.first);
        const GraphPass* now = next.find(item.first);
        return before == nullptr || now == nullptr || before->type != now->type ||
               before->properties != now->properties;
    });
}

void Renderer::setGraph(Graph graph) {
    requireValid(graph, registry_);
    dropGrowth(graph);
    try {
        compileGraph(graph);
    } catch (...) {
        // Pass objects are shared with the plan that stays: their properties go back.
        reusePasses(graph_, registry_, passes_);
        throw;
    }
    graph_ = std::move(graph);
}

void Renderer::set(const std::string& setting) {
    Graph changed = graph_;
    applySetting(changed, registry_, setting);
    setGraph(std::move(changed));
}

void Renderer::setSize(Extent size) {
    const Extent before = std::exchange(options_.size, size);
    if (before == size) return;
    grown_.clear();
    try {
        compileGraph(graph_);
    } catch (...) {
        options_.size = before;
        throw;
    }
}

void Renderer::setPreviews(std::vector<PortRef> previews) {
    std::swap(options_.previews, previews);
    if (options_.previews == previews) return;
    try {
        compileGraph(graph_);
    } catch (...) {
        options_.previews = std::move(previews);
        throw;
    }
}

void Renderer::setScene(Scene scene) {
    const int camera = cameraIndex(scene, "");
    const SceneFacts before = std::exchange(facts_, gatherFacts(scene));
    grown_.clear();
    try {
        compileGraph(graph_);
    } catch (...) {
        facts_ = before;
        throw;
    }
    flattener_.reset(); // it reads the scene before
    geometry_ = nullptr;
    scene_ = std::move(scene);
    gpu_ = std::make_unique<GpuScene>(scene_);
    camera_ = camera;
    freeCamera_.reset();
    geometryMade_ = false;
    lastConditions_.reset();
    rewoundFrom_.reset();
    time_ = scene_.startTime;
}

bool Renderer::reloadIfChanged() {
    const bool shaders = executor_->shaders().changed(); // forgets what changed
    if (!shaders && !changed(files_)) return false;
    compileGraph(graph_);
    return true;
}

// ---- time and camera

void Renderer::setCamera(const std::string& name) {
    camera_ = cameraIndex(scene_, name);
    freeCamera_.reset();
}

void Renderer::setTiming(bool timing) {
    options_.timing = timing;
    executor_->options.timing = timing;
}

void Renderer::setTime(double seconds) { jump_ = seconds; }

void Renderer::restart() {
    index_ = 0;
    time_ = scene_.startTime;
    lastConditions_.reset();
    rewoundFrom_.reset();
    geometryMade_ = false;
}

void Renderer::rewind() {
    if (lastConditions_) {
        rewoundFrom_ = std::move(lastConditions_);
        executor_->rewind();
    }
    index_ = 0;
    time_ = scene_.startTime;
    lastConditions_.reset();
}

std::string Renderer::cameraName() const {
    return freeCamera_ ? "free" : scene_.cameras.at(static_cast<size_t>(camera_)).name;
}

bool Renderer::moves() const {
    return facts_.duration > 0 && (facts_.geometryMoves || facts_.cameraMoves || facts_.lightsMove);
}

void Renderer::takeTime() {
    const double before = time_;
    jumped_ = false;
    if (jump_) {
        time_ = *jump_;
        jumped_ = time_ != before;
    } else if (moves() && !paused_ && lastConditions_) {
        time_ = timeAfter(before, facts_.duration, timeStep());
        jumped_ = before + timeStep() > facts_.duration;
    }
    jump_.reset();
}

// The scene at this frame's time. Once things stand still, the last positions are those of now.
void Renderer::takeGeometry() {
    const double previous = jumped_ || !lastConditions_ ? time_ : lastConditions_->time;
    if (geometryMade_ &&
        (!facts_.geometryMoves || (geometryTime_ == time_ && geometryPreviousTime_ == previous)))
        return;
    if (!flattener_) flattener_.emplace(scene_);
    geometry_ = &flattener_->at(time_, previous);
    gpu_->update(*geometry_);
    geometryTime_ = time_;
    geometryPreviousTime_ = previous;
    geometryMade_ = true;
}

FrameInfo Renderer::frameInfo() const {
    FrameInfo info;
    info.index = index_;
    info.seed = options_.seed;
    info.time = time_;
    info.size = options_.size;
    info.camera = freeCamera_ ? -1 : camera_;
    info.cameraState = freeCamera_ ? *freeCamera_ : cameraAt(scene_, camera_, time_);
    const bool cut = !lastConditions_ || jumped_ || lastConditions_->camera != info.camera;
    info.previousCameraState = cut ? info.cameraState : lastConditions_->cameraState;
    return info;
}

// ---- frames

// Until no pass overflows; returns how often the plan was compiled anew.
int Renderer::runFrame(const FrameScene& frame, Causes events) {
    int recompiled = 0;
    std::map<std::pair<std::string, std::string>, int> growths; // by pass and port
    try {
        while (!executor_->run(frame, events)) {
            const std::map<std::string, Growth> needed = executor_->report().overflows;
            ++recompiled;
            // At once as many as were wanted; where that was not enough, by half at least, so that what grows
            // a little every frame is not compiled anew every frame.
            for (const auto& [pass, ports] : needed)
                for (const auto& [port, elements] : ports) {
                    if (++growths[{pass, port}] > maxGrowths)
                        throw MachineError(
                            fmt::format("{}.{} overflows after growing {} times; it now asks for {} elements",
                                        pass, port, maxGrowths, elements));
                    std::uint64_t& grown = grown_[pass][port];
                    grown = std::max(elements, grown + grown / 2);
                }
            compileGraph(graph_);
        }
    } catch (...) {
        executor_->abandonFrame();
        throw;
    }
    return recompiled;
}

const FrameRecord& Renderer::frame() {
    const auto start = Clock::now();
    takeTime();
    takeGeometry();
    lights_ = lightsAt(scene_, time_);
    gpu_->setLights(lights_);
    FrameScene frame{frameInfo(), &scene_, &facts_, geometry_, &lights_, gpu_.get(), time_, &lights_};
    if (lastConditions_ && !jumped_) {
        frame.previousTime = lastConditions_->time;
        frame.previousLights = &lastConditions_->lights;
    }
    const FrameConditions now{frame.info.camera, frame.info.cameraState, time_,
                              jumped_,           options_.size,          lights_};
    const Causes events = lastConditions_ ? eventsBetween(*lastConditions_, now, facts_)
                          : rewoundFrom_  ? eventsBetween(*rewoundFrom_, now, facts_)
                                          : Causes::All;

    const int recompiled = runFrame(frame, events);
    if (options_.timing || options_.finishFrames) gl::finish();
    gl::requireLiveContext();

    record_ = {index_,     millisecondsSince(start), events, executor_->samples(), executor_->report().values,
               recompiled, executor_->report().bad};
    lastConditions_ = now;
    rewoundFrom_.reset();
    ++index_;
    if (!record_.bad.empty() && !options_.keepBad) {
        std::vector<Problem> problems;
        for (const BadOutput& bad : record_.bad)
            problems.push_back({{}, fmt::format("frame {}: {}", record_.index, bad.text())});
        throw Error(ExitStatus::MeasureFailed, std::move(problems));
    }
    return record_;
}

// ---- reading

Image Renderer::read(const PortRef& port, int layer, int mip) {
    const int resource = heldResource(plan(), port);
    if (executor_->resources().isBuffer(resource))
        throw InputError(fmt::format("{} is a buffer, not an image", port.text()));
    return executor_->resources().texture(resource).downloadImage(layer, mip);
}

std::vector<std::byte> Renderer::readBytes(const PortRef& port) {
    const int resource = heldResource(plan(), port);
    if (executor_->resources().isBuffer(resource)) return executor_->resources().buffer(resource).download();
    return executor_->resources().texture(resource).download();
}

const Desc& Renderer::desc(const PortRef& port) const {
    return plan().resources.at(static_cast<size_t>(heldResource(plan(), port))).desc;
}

namespace {

// Why a plan does not hold a port that the graph has.
std::string whyNotHeld(const Plan& plan, const PortRef& port) {
    for (const std::vector<LeftOut>* items : {&plan.previews.leftOut, &plan.leftOut})
        for (const LeftOut& item : *items)
            if (item.what == port.text() || item.what == port.pass)
                return fmt::format("{} is left out, because {}", port.text(), item.why);
    return {};
}

// The other ports whose content lies in bytes of this resource at other times of a frame.
std::vector<std::string> sharers(const Plan& plan, int resource) {
    const PlanResource& held = plan.resources.at(static_cast<size_t>(resource));
    const auto end = [](const PlanResource& of) { return of.offset + of.desc.totalBytes(); };
    std::vector<std::string> ports;
    for (const PlanResource& other : plan.resources)
        if (&other != &held && other.object >= 0 && other.object == held.object && other.offset < end(held) &&
            held.offset < end(other))
            ports.push_back(other.port.text());
    return ports;
}

} // namespace

int heldResource(const Plan& plan, const PortRef& port) {
    for (const PlanOutput& output : plan.outputs)
        if (output.port == port && output.resource >= 0) return output.resource;
    std::vector<std::string> names;
    for (const PlanPass& pass : plan.passes)
        for (const auto& [name, desc] : pass.descs) {
            const auto found = pass.ports.find(name);
            const bool held = found != pass.ports.end() && found->second >= 0;
            if (PortRef{pass.name, name} == port) {
                if (!held)
                    throw InputError(fmt::format("{} is a shader module: it has no content", port.text()));
                if (const std::vector<std::string> others = sharers(plan, found->second); !others.empty())
                    throw InputError(fmt::format(
                        "{} shares its memory with {}, so that its content is lost within the frame: "
                        "ask for it as a preview (RenderOptions::previews, --output)",
                        port.text(), fmt::join(others, ", ")));
                return found->second;
            }
            if (held) names.push_back(pass.name + "." + name);
        }
    const std::string why = whyNotHeld(plan, port);
    throw InputError(why.empty()
                         ? fmt::format("there is no port {}{}", port.text(), didYouMean(port.text(), names))
                         : why);
}

} // namespace kestrel
