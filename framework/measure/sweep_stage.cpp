#include "measure/sweep_stage.h"
#include "core/files.h"
#include "core/hash.h"
#include "core/log.h"
#include "gl/context.h"
#include "image/error_figures.h"
#include "image/io.h"
#include "measure/sweep_hits.h"
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace kestrel {
namespace {

std::string bytesHash(std::span<const std::byte> bytes) {
    Fnv1a hash;
    hash.add(bytes);
    return fmt::format("{:016x}", hash.value());
}

// So that all but the brightest hundredth of the reference is shown without being cut off.
double exposureFor(const Image& reference) {
    std::vector<float> light = convertChannels(reference, 1).values;
    std::erase_if(light, [](float value) { return !std::isfinite(value); });
    if (light.empty()) return 1;
    const auto at = light.begin() + static_cast<std::ptrdiff_t>(99 * (light.size() - 1) / 100);
    std::nth_element(light.begin(), at, light.end());
    return *at > 0 ? 1 / static_cast<double>(*at) : 1;
}

std::filesystem::path folderOf(const Sweep& sweep) {
    return sweep.file.has_parent_path() ? sweep.file.parent_path() : ".";
}

} // namespace

std::map<std::string, double> sweepReports(const Renderer& renderer) {
    std::map<std::string, double> reports;
    for (const auto& [pass, values] : renderer.last().values)
        for (const auto& [key, value] : values) reports[pass + "." + key] = value;
    return reports;
}

void writeSweepPicture(const std::filesystem::path& file, Image image, bool light, double exposure) {
    if (image.channels == 4) image = convertChannels(image, 3);
    for (float& value : image.values) value *= light ? static_cast<float>(exposure) : 1;
    writeImage(file, image, light ? Encoding::Srgb : Encoding::Linear);
}

std::string sweepMessage(const Error& error) {
    std::string text;
    for (const Problem& problem : error.problems()) text += (text.empty() ? "" : "; ") + problem.text();
    return text;
}

SweepStage::SweepStage(const SweepRun& run, const SweepScene& scene)
    : run_(run)
    , sweep_(run.sweep)
    , scene_(scene) {
    if (auto held = run_.folder.reference(scene)) {
        record_ = std::move(*held);
        readReference();
        return;
    }
    const auto file = [&](const char* ending) {
        return run_.folder.path() / run_.folder.referenceName(scene_, ending);
    };
    if (sweep_.reference) {
        renderReference();
        writeImage(file(".exr"), reference_, Encoding::Linear);
        if (!mask_.empty()) writeImage(file(".mask.exr"), mask_, Encoding::Linear);
        record_.picture = run_.folder.referenceName(scene_, ".png");
        writeSweepPicture(run_.folder.path() / record_.picture, reference_, sweep_.hdr, record_.exposure);
    }
    if (sweep_.rays) {
        traceReference();
        writeFile(file(".hits"), std::as_bytes(std::span(distances_)));
    }
    run_.folder.write(scene_, record_); // last: it says that the others are whole
}

// ---- renderers

// The scene under a setup. Graphs seldom set it up differently: the last one is kept.
const Scene& SweepStage::sceneUnder(const SceneSetup& setup) {
    std::string text = setupText(setup);
    if (loadedSetup_ == text) return loaded_;
    loaded_ = loadScene(scene_.source, folderOf(sweep_), {.allowOutside = sweep_.allowOutside}, setup);
    for (const std::string& warning : loaded_.warnings)
        if (warned_.insert(warning).second) logWarning("{}: {}", scene_.name, warning);
    loadedSetup_ = std::move(text);
    return loaded_;
}

std::unique_ptr<Renderer> SweepStage::open(const std::string& graphName,
                                           const std::vector<SweepSetting>& settings,
                                           const std::vector<PortRef>& outputs, const Location& where) {
    RenderOptions options;
    options.size = sweep_.size;
    options.seed = sweep_.seed;
    options.timing = true;
    options.finishFrames = true;
    Graph graph = sweepGraph(sweep_, graphName, settings, outputs, run_.registry, where);
    // As renderCommand() has it: what the sweep says of the scene counts before what the graph says.
    graph.sceneSetup = joined(located(std::move(graph.sceneSetup), graph.file.parent_path()),
                              located(scene_.setup, folderOf(sweep_)));
    const Scene& scene = sceneUnder(graph.sceneSetup);
    auto renderer = std::make_unique<Renderer>(std::move(graph), run_.registry, scene,
                                               run_.context.capabilities(), options);
    renderer->setPaused(!sweep_.moving);
    return renderer;
}

std::vector<PortRef> SweepStage::outputsOf(const SweepPoint& point) const {
    std::vector<PortRef> outputs{point.output};
    if (point.ray) outputs.push_back(sweep_.rays->rays);
    return outputs;
}

std::unique_ptr<Renderer> SweepStage::open(const SweepPoint& point) {
    return open(point.graph, point.settings, outputsOf(point), point.where);
}

void SweepStage::change(Renderer& renderer, const SweepPoint& point) const {
    renderer.setGraph(
        sweepGraph(sweep_, point.graph, point.settings, outputsOf(point), run_.registry, point.where));
    renderer.rewind();
}

// When the last frame of a moving picture is.
double SweepStage::timeOfPicture(const Renderer& renderer) const {
    const Scene& scene = renderer.scene();
    double time = scene.startTime;
    for (int i = 1; i < sweep_.frames; ++i)
        time = timeAfter(time, renderer.facts().duration, 1 / scene.frameRate);
    return time;
}

// ---- the reference

void SweepStage::readReference() {
    const auto file = [&](const char* ending) {
        return run_.folder.path() / run_.folder.referenceName(scene_, ending);
    };
    if (sweep_.reference) reference_ = readImage(file(".exr"));
    if (sweep_.reference && sweep_.reference->mask) mask_ = readImage(file(".mask.exr"));
    if (!sweep_.rays) return;
    const std::vector<std::byte> bytes = readBytes(file(".hits"));
    distances_.resize(bytes.size() / sizeof(float));
    if (!distances_.empty()) std::memcpy(distances_.data(), bytes.data(), distances_.size() * sizeof(float));
}

Image SweepStage::renderReference(std::uint32_t seed, Image* mask, std::map<std::string, double>* reports) {
    const SweepReference& asked = *sweep_.reference;
    run_.tell(scene_.name + ": the reference");
    std::vector<PortRef> outputs{asked.output};
    if (asked.mask) outputs.push_back(*asked.mask);
    const auto renderer = open(asked.graph, asked.settings, outputs, asked.where);
    renderer->setSeed(seed);
    renderer->setPaused(true);
    if (sweep_.moving) renderer->setTime(timeOfPicture(*renderer));
    for (int i = 0; i < asked.frames; ++i) static_cast<void>(renderer->frame());
    if (mask != nullptr && asked.mask) *mask = convertChannels(renderer->read(*asked.mask), 1);
    if (reports != nullptr) *reports = sweepReports(*renderer);
    return renderer->read(asked.output);
}

void SweepStage::renderReference() {
    const SweepReference& asked = *sweep_.reference;
    reference_ = renderReference(sweep_.seed, &mask_, &record_.reports);
    if (blankMask())
        logWarning("{}: the mask {} is 0 everywhere: no pixel counts, and nothing here has an error",
                   scene_.name, asked.mask->text());
    record_.nothingCounts = blankMask();
    record_.exposure = sweep_.hdr ? exposureFor(reference_) : 1;
    const auto noise = record_.reports.find(asked.output.pass + ".noise");
    if (noise != record_.reports.end()) record_.noise = noise->second;
}

bool SweepStage::blankMask() const {
    return !mask_.empty() && std::ranges::none_of(mask_.values, [](float value) { return value > 0.5F; });
}

void SweepStage::traceReference() {
    const SweepRays& asked = *sweep_.rays;
    run_.tell(scene_.name + ": the reference's rays");
    const auto renderer = open(asked.graph, asked.settings, {asked.hits, asked.rays}, asked.where);
    for (int i = 0; i < asked.frames; ++i) static_cast<void>(renderer->frame());
    const std::vector<std::byte> rays = renderer->readBytes(asked.rays);
    distances_ = hitDistances(renderer->readBytes(asked.hits), rays);
    const SweepRayFigures figures = compareHits(rays, distances_, distances_);
    record_.rays = figures.rays;
    record_.hitShare = figures.hitShare;
    record_.raysHash = bytesHash(rays);
}

// ---- errors

SweepComparison SweepStage::compare(Renderer& renderer, const SweepPoint& point, Image* flipMap,
                                    const std::string& only) const {
    SweepComparison result;
    if (point.ray) {
        const std::vector<std::byte> rays = renderer.readBytes(sweep_.rays->rays);
        if (bytesHash(rays) != record_.raysHash)
            throw InputError(point.where,
                             "traces other rays than the reference: graph, settings or frames that make "
                             "the rays differ");
        result.rays = compareHits(rays, hitDistances(renderer.readBytes(point.output), rays), distances_);
        return result;
    }
    if (record_.nothingCounts) return result;
    const ErrorFigures figures = measureError(reference_, renderer.read(point.output),
                                              {.hdr = sweep_.hdr,
                                               .mask = mask_.empty() ? nullptr : &mask_,
                                               .ssim = only.empty() || only == "ssim",
                                               .flip = only.empty() || only == "flip"},
                                              flipMap);
    result.errors = SweepErrors{figures.mse, figures.ssim, figures.flip.mean, std::nullopt};
    if (std::isfinite(figures.psnr)) result.errors->psnr = figures.psnr;
    return result;
}

// ---- the error taken apart

void SweepStage::takeSecondReference() {
    if (!second_.empty()) return;
    const std::filesystem::path file = run_.folder.path() / run_.folder.referenceName(scene_, ".second.exr");
    std::error_code ignored;
    if (std::filesystem::exists(file, ignored)) {
        second_ = readImage(file);
        return;
    }
    second_ = renderReference(sweep_.seed + 1, nullptr, nullptr);
    writeImage(file, second_, Encoding::Linear);
}

Image SweepStage::picture(const SweepPoint& point, std::uint32_t seed) {
    const auto renderer = open(point);
    renderer->setSeed(seed);
    for (int i = 0; i < point.frames; ++i) static_cast<void>(renderer->frame());
    return renderer->read(point.output);
}

std::optional<ErrorSplit> SweepStage::split(const SweepPoint& point, const Image& first) {
    if (record_.nothingCounts) return std::nullopt;
    takeSecondReference();
    const SweepPoint exact = exactOf(point);
    return splitError({first, picture(point, sweep_.seed + 1)},
                      {picture(exact, sweep_.seed), picture(exact, sweep_.seed + 1)}, {reference_, second_},
                      mask_.empty() ? nullptr : &mask_);
}

// ---- times

std::vector<SweepFrame> SweepStage::timeTurn(Renderer& renderer, bool fresh) const {
    // A renderer that was just made has everything to build in its first frame.
    const int warmUp = sweep_.warmUp + (fresh && sweep_.warmUp == 0 ? 1 : 0);
    if (sweep_.moving) renderer.restart(); // every repetition sees the same frames
    for (int i = 0; i < warmUp; ++i) nextFrame(renderer);
    std::vector<SweepFrame> frames;
    for (int i = 0; i < sweep_.timedFrames; ++i) {
        nextFrame(renderer);
        SweepFrame frame;
        frame.ms = renderer.last().ms;
        for (const StepSample& sample : renderer.last().samples)
            frame.steps.push_back({sample.pass, sample.step, sample.group, sample.ms});
        frames.push_back(std::move(frame));
    }
    return frames;
}

void SweepStage::nextFrame(Renderer& renderer) const {
    if (sweep_.rebuild) renderer.restart();
    static_cast<void>(renderer.frame());
}

} // namespace kestrel
