#include "measure/stress/stress_run.h"
#include "core/check.h"
#include "execute/finite.h"
#include "image/io.h"
#include "measure/stress/stress_distance.h"
#include "measure/stress/stress_limits.h"
#include "scene/setup.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <set>

namespace kestrel {
namespace {

constexpr int seedsOfBase = 3;

std::string refusalText(const Error& error) {
    std::string text;
    for (const Problem& problem : error.problems()) text += (text.empty() ? "" : "; ") + problem.text();
    return text;
}

// Values of a place, a direction or a depth differ where the scene does.
bool isComparable(const PortInfo* port) {
    return port == nullptr || port->content.space == Space::Any || port->content.space == Space::Display;
}

StressDistance meanDistance(const std::vector<Image>& pictures) {
    StressDistance sum;
    int pairs = 0;
    for (size_t i = 0; i < pictures.size(); ++i)
        for (size_t j = i + 1; j < pictures.size(); ++j, ++pairs) {
            const StressDistance one = stressDistance(pictures[i], pictures[j]);
            sum.mean += one.mean;
            sum.rms += one.rms;
        }
    if (pairs > 0) sum.mean /= pairs;
    if (pairs > 0) sum.rms /= pairs;
    return sum;
}

std::string fileName(std::string text) {
    for (char& c : text)
        if (c == '/') c = '-';
    return text;
}

} // namespace

std::string keptPictureName(const std::string& name, const std::string& port) {
    return fileName(name) + "." + port + ".exr";
}

StressRunner::StressRunner(Graph graph, Scene scene, const Registry& registry,
                           const Capabilities& capabilities, StressOptions options)
    : graph_(std::move(graph))
    , scene_(std::move(scene))
    , registry_(registry)
    , capabilities_(capabilities)
    , options_(std::move(options)) {
    graph_.sceneSetup = {}; // of the scene, which is set up; a scene of a case has cameras of its own
    const SceneFacts facts = gatherFacts(scene_);
    if (facts.sphere.radius > 0) radius_ = double{facts.sphere.radius};
}

const PortInfo* StressRunner::portInfo(const PortRef& port) const {
    const GraphPass* pass = graph_.find(port.pass);
    const PassType* type = pass != nullptr ? registry_.find(pass->type) : nullptr;
    return type != nullptr ? type->port(port.port) : nullptr;
}

// ---- rendering

void StressRunner::applyEvent(Renderer& renderer, const StressEvent& event, const CameraState& camera) const {
    switch (event.what) {
    case StressEvent::What::Camera: {
        CameraState moved = camera;
        const float way = static_cast<float>(event.value * radius_);
        const glm::vec3 right(camera.view[0][0], camera.view[1][0], camera.view[2][0]);
        moved.position += way * right;
        moved.view[3][0] -= way;
        renderer.setFreeCamera(moved);
        break;
    }
    case StressEvent::What::Cut:
        renderer.setFreeCamera(std::nullopt);
        break;
    case StressEvent::What::TimeStep:
        renderer.setTimeStep(event.value);
        break;
    case StressEvent::What::Pause:
        renderer.setPaused(event.value != 0);
        break;
    }
}

StressRunner::Pictures StressRunner::read(Renderer& renderer) const {
    Pictures pictures;
    for (const PlanOutput& output : renderer.plan().outputs) {
        if (output.preview || output.resource < 0 || !isComparable(portInfo(output.port))) continue;
        const Desc& desc = renderer.desc(output.port);
        if (desc.kind != ResourceKind::Texture2D || formatInfo(desc.format).depth) continue;
        Image picture = renderer.read(output.port);
        // What a port says that it carries: a fourth channel beside a colour may count its samples, and they
        // differ.
        const PortInfo* info = portInfo(output.port);
        const int channels = info != nullptr ? info->content.channels : 0;
        if (channels > 1 && channels < picture.channels) picture = convertChannels(picture, channels);
        pictures.emplace(output.port.text(), std::move(picture));
    }
    return pictures;
}

// `plain`: without the case's events, and as the graph is run usually.
StressRunner::Rendered StressRunner::render(const StressCase& one, const SceneEdit& edit, std::uint32_t seed,
                                            bool plain) {
    Scene scene = one.scene.empty() ? scene_ : loadScene(one.scene);
    editScene(scene, edit);
    RenderOptions options;
    options.size = one.size.value_or(options_.size);
    options.seed = seed;
    options.keepAll = options_.keepAll || (one.keepAll && !plain);
    options.shareMemory = plain || !one.noSharing;
    options.countIterations = one.countIterations && !plain;
    options.checkFinite = options.keepBad = true;
    Renderer renderer(stressGraph(graph_, registry_, edit.scale, one.properties), registry_, std::move(scene),
                      capabilities_, options);
    renderer.executor().report().begins = options_.begins;
    Rendered rendered;
    if (one.expects == StressExpects::EnergyHeld)
        renderer.executor().report().look = [&](const PortRef& port, const Image& image) {
            const PortInfo* info = portInfo(port);
            if (info != nullptr && info->content.channels >= 3 && info->content.space == Space::Any)
                rendered.light[port.text()].add(image);
        };
    const CameraState camera =
        cameraAt(renderer.scene(), renderer.scene().camera, renderer.scene().startTime);
    // What recovers is compared with what was there all the time: a time that stands still.
    const bool recovers = one.expects == StressExpects::Recovers;
    if (recovers && (plain || one.edit.blinkFrames == 0)) renderer.setPaused(true);

    std::set<std::string> bad;
    const int all = options_.frames.value_or(one.frames);
    const int frames = recovers && plain ? all / 2 : all;
    for (int i = 0; i < frames; ++i) {
        if (!plain)
            for (const StressEvent& event : one.events)
                if (event.frame == i) applyEvent(renderer, event, camera);
        for (const BadOutput& found : renderer.frame().bad)
            if (bad.insert(found.pass + "." + found.port).second) rendered.bad.push_back(found);
    }
    rendered.pictures = read(renderer);
    for (const PlanPass& pass : renderer.plan().passes)
        for (const auto& [port, resource] : pass.ports) {
            const PortInfo* info = portInfo({pass.name, port});
            const bool own = info != nullptr && info->direction != PortDirection::Input;
            if (resource < 0 || !own) continue;
            const Format format = renderer.plan().resources[static_cast<size_t>(resource)].desc.format;
            if (format != Format::None && !formatInfo(format).integer)
                rendered.ports.push_back({pass.name, port});
        }
    return rendered;
}

// The picture without the case: of the same scene, size and number of frames, from several seeds.
const StressRunner::Base& StressRunner::base(const StressCase& one) {
    StressCase plain;
    plain.expects = one.expects == StressExpects::Recovers ? one.expects : StressExpects::Nothing;
    plain.size = one.size;
    plain.frames = one.frames;
    SceneEdit edit;
    if (plain.expects == StressExpects::Recovers) {
        edit = one.edit;
        edit.blinkFrames = 0;
    }
    const Extent size = one.size.value_or(options_.size);
    const std::string key = fmt::format("{}x{} {} {}", size.width, size.height, one.frames,
                                        edit == SceneEdit{}   ? ""
                                        : edit.lights.empty() ? "still"
                                                              : "lit");
    const auto found = bases_.find(key);
    if (found != bases_.end()) return found->second;
    std::map<std::string, std::vector<Image>> all;
    Base made;
    for (int seed = 0; seed < seedsOfBase; ++seed) {
        Pictures pictures = render(plain, edit, static_cast<std::uint32_t>(seed), true).pictures;
        for (const auto& [port, image] : pictures) all[port].push_back(image);
        if (seed == 0) made.picture = std::move(pictures);
    }
    for (const auto& [port, images] : all) made.seeds[port] = meanDistance(images);
    return bases_.emplace(key, std::move(made)).first->second;
}

// ---- what must hold

void StressRunner::addFinite(StressResult& result, const Rendered& rendered) const {
    for (const PortRef& port : rendered.ports) {
        StressCheck check{.port = port.text(), .expects = "finite"};
        for (const BadOutput& bad : rendered.bad) {
            if (bad.pass != port.pass || bad.port != port.port) continue;
            check.held = false;
            check.missed = static_cast<double>(bad.first.count);
            check.x = bad.first.x;
            check.y = bad.first.y;
            check.what = bad.text();
        }
        result.checks.push_back(std::move(check));
    }
    // In the order in which they came up: the first is where it began.
    std::ranges::stable_sort(result.checks, [&](const StressCheck& a, const StressCheck& b) {
        const auto at = [&](const StressCheck& check) {
            for (size_t i = 0; i < rendered.bad.size(); ++i)
                if (rendered.bad[i].pass + "." + rendered.bad[i].port == check.port) return i;
            return rendered.bad.size();
        };
        return at(a) < at(b);
    });
}

void StressRunner::addEnergy(StressResult& result, const StressCase& one, const Rendered& rendered) const {
    const double room = closedRoomLight(graph_, registry_, one.reflectance);
    for (const auto& [port, mean] : rendered.light) {
        // Rounding, and four standard errors of the mean, which chance exceeds once in thirty thousand.
        const double most = room * 1.001 + 4 * mean.error();
        StressCheck check{.port = port, .expects = std::string(stressExpectsName(one.expects))};
        check.missed = mean.mean() / most;
        check.held = mean.mean() <= most;
        if (!check.held)
            check.what = fmt::format(
                "pass '{}', port '{}', holds {:.4g} in the mean (standard error {:.2g}) where a closed "
                "room has at most {:.4g}",
                port.substr(0, port.find('.')), port.substr(port.find('.') + 1), mean.mean(), mean.error(),
                room);
        result.checks.push_back(std::move(check));
    }
}

void StressRunner::keepPicture(StressCheck& check, const StressCase& one, const Image& truth,
                               const Image& image) const {
    if (options_.pictures.empty()) return;
    // Side by side, as display values.
    const int gap = 2;
    Image both(truth.width + gap + image.width, std::max(truth.height, image.height), 3, 1);
    const auto put = [&](const Image& from, int x0) {
        const Image three = convertChannels(from, 3);
        for (int y = 0; y < from.height; ++y)
            for (int x = 0; x < from.width; ++x)
                for (int c = 0; c < 3; ++c) {
                    const float value = three.at(x, y, c);
                    // What is no number is magenta.
                    both.at(x0 + x, y, c) = std::isfinite(value) ? std::clamp(value, 0.0f, 1.0f)
                                            : c == 1             ? 0.0f
                                                                 : 1.0f;
                }
    };
    put(truth, 0);
    put(image, truth.width + gap);
    check.picture = fmt::format("pictures/{}.{}.png", fileName(one.name), check.port);
    writeImage(options_.pictures / (fileName(one.name) + "." + check.port + ".png"), both, Encoding::Linear);
}

void StressRunner::addComparison(StressResult& result, const StressCase& one, const Pictures& truth,
                                 const std::map<std::string, StressDistance>& seeds,
                                 const Pictures& pictures) const {
    for (const auto& [port, image] : pictures) {
        const auto other = truth.find(port);
        if (other == truth.end()) continue;
        const Image seen = one.expects == StressExpects::Mirrored ? mirrored(image) : image;
        const StressDistance distance = stressDistance(other->second, seen);
        const auto noise = seeds.find(port);
        StressCheck check{.port = port, .expects = std::string(stressExpectsName(one.expects))};
        check.missed = stressRatio(distance, noise == seeds.end() ? StressDistance{} : noise->second);
        if (check.missed > 1) {
            check.held = false;
            check.x = distance.x;
            check.y = distance.y;
            check.what = fmt::format(
                "pass '{}', port '{}', differs most at pixel ({}, {}): the picture is {:.3g} times "
                "as far from {} as it may be (mean {:.3g}, root mean square {:.3g}, relative)",
                port.substr(0, port.find('.')), port.substr(port.find('.') + 1), distance.x, distance.y,
                check.missed,
                one.expects == StressExpects::AnyOrder   ? "that of the triangles in opposite order"
                : one.expects == StressExpects::Recovers ? "that without the events"
                                                         : "the plain one",
                distance.mean, distance.rms);
            keepPicture(check, one, other->second, seen);
        }
        result.checks.push_back(std::move(check));
    }
}

StressResult StressRunner::run(const StressCase& one) {
    StressResult result;
    result.name = one.name;
    const auto start = std::chrono::steady_clock::now();
    try {
        const Rendered rendered = render(one, one.edit, one.seed, false);
        addFinite(result, rendered);
        if (!options_.keep.empty())
            for (const auto& [port, image] : rendered.pictures)
                writeImage(options_.keep / keptPictureName(one.name, port), image, Encoding::Linear);
        if (one.expects == StressExpects::EnergyHeld) addEnergy(result, one, rendered);
        const bool compares = one.expects == StressExpects::Same || one.expects == StressExpects::Mirrored ||
                              one.expects == StressExpects::Recovers;
        if (compares) {
            const Base& plain = base(one);
            addComparison(result, one, plain.picture, plain.seeds, rendered.pictures);
        }
        if (one.expects == StressExpects::AnyOrder) {
            SceneEdit reversed = one.edit;
            reversed.triangles = SceneEdit::Triangles::Reversed;
            const Rendered other = render(one, reversed, one.seed, false);
            const Rendered noise = render(one, one.edit, one.seed + 1, false);
            std::map<std::string, StressDistance> seeds;
            for (const auto& [port, image] : noise.pictures)
                seeds[port] = stressDistance(rendered.pictures.at(port), image);
            addComparison(result, one, rendered.pictures, seeds, other.pictures);
        }
        applyStressLimits(result, graph_);
        for (const StressCheck& check : result.checks)
            if (!check.held) result.outcome = StressOutcome::Missed;
    } catch (const Error& error) {
        result.outcome = error.status() == ExitStatus::MachineLacks    ? StressOutcome::Lacking
                         : error.status() == ExitStatus::MeasureFailed ? StressOutcome::Missed
                         : one.properties.empty()                      ? StressOutcome::Refused
                                                                       : StressOutcome::Unfit;
        result.why = refusalText(error);
    }
    result.ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return result;
}

} // namespace kestrel
