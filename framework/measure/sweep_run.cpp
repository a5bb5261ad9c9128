#include "measure/sweep_run.h"
#include "core/files.h"
#include "core/hash.h"
#include "core/log.h"
#include "core/spin.h"
#include "execute/renderer.h"
#include "gl/context.h"
#include "image/colormap.h"
#include "image/error_figures.h"
#include "image/io.h"
#include "measure/sweep_hits.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <set>

namespace kestrel {
namespace {

using SweepClock = std::chrono::steady_clock;

// Renderers stay alive between their repetitions while what they hold together is less; the others are made
// anew for each repetition.
constexpr std::uint64_t sweepMemory = std::uint64_t{6} << 30;

double msSince(SweepClock::time_point start) {
    return std::chrono::duration<double, std::milli>(SweepClock::now() - start).count();
}

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
    std::ranges::nth_element(light, at);
    return *at > 0 ? 1 / static_cast<double>(*at) : 1;
}

void writePicture(const std::filesystem::path& file, Image image, bool light, double exposure) {
    if (image.channels == 4) image = convertChannels(image, 3);
    for (float& value : image.values) value *= light ? static_cast<float>(exposure) : 1;
    writeImage(file, image, light ? Encoding::Srgb : Encoding::Linear);
}

std::string messageOf(const Error& error) {
    std::string text;
    for (const Problem& problem : error.problems()) text += (text.empty() ? "" : "; ") + problem.text();
    return text;
}

class SweepRunner {
public:
    SweepRunner(const Sweep& sweep, const std::vector<SweepPoint>& points, const Registry& registry,
                gl::Context& context, const SweepMachine& machine, const SweepFolder& folder)
        : sweep_(sweep)
        , points_(points)
        , registry_(registry)
        , context_(context)
        , machine_(machine)
        , folder_(folder) {}

    // How much there is to do, for progress: a picture counts as a repetition.
    [[nodiscard]] int workOf(const std::vector<SweepUnit>& units, const SweepOptions& options) const {
        int work = 0;
        for (size_t i = 0; i < units.size(); ++i)
            if (options.shard.has(i)) work += static_cast<int>(chosenOf(units[i], options).size());
        return work * (1 + sweep_.repeats);
    }

    void run(const std::vector<SweepUnit>& units, const SweepOptions& options) {
        progress_ = options.progress;
        work_ = std::max(1, workOf(units, options));
        for (size_t i = 0; i < units.size(); ++i)
            if (options.shard.has(i)) runUnit(units[i], chosenOf(units[i], options));
    }

private:
    struct Candidate {
        const SweepPoint* point = nullptr;
        std::unique_ptr<Renderer> renderer; // empty: made for each repetition
    };

    [[nodiscard]] static std::vector<int> chosenOf(const SweepUnit& unit, const SweepOptions& options) {
        std::vector<int> chosen;
        for (const int index : unit.points)
            if (options.chosen.empty() || options.chosen[static_cast<size_t>(index)]) chosen.push_back(index);
        return chosen;
    }

    void tell(const std::string& what, bool finished) {
        done_ += finished ? 1 : 0;
        if (progress_) progress_(static_cast<double>(done_) / work_, what);
    }

    [[nodiscard]] bool complete(const SweepUnit& unit, const std::vector<int>& chosen) const {
        return std::ranges::all_of(chosen, [&](int index) {
            const SweepPoint& point = points_[static_cast<size_t>(index)];
            const auto picture = folder_.picture(unit, point);
            if (!picture) return false;
            if (!picture->failed.empty()) return true;
            for (int round = 0; round < sweep_.repeats; ++round)
                if (!folder_.hasTurn(unit, point, round)) return false;
            return true;
        });
    }

    // ---- a unit

    void runUnit(const SweepUnit& unit, const std::vector<int>& chosen) {
        if (chosen.empty() || complete(unit, chosen)) {
            done_ += static_cast<int>(chosen.size()) * (1 + sweep_.repeats);
            return;
        }
        const SweepScene& scene = sweep_.scenes[static_cast<size_t>(unit.scene)];
        tell(scene.name, false);
        scene_ = &scene;
        loadedSetup_.reset();
        takeReference(scene);

        std::vector<Candidate> candidates;
        std::uint64_t held = 0;
        for (const int index : chosen) {
            const SweepPoint& point = points_[static_cast<size_t>(index)];
            tell(scene.name + ": " + point.name, false);
            Candidate candidate{&point, nullptr};
            if (measurePicture(unit, candidate)) {
                if (candidate.renderer) {
                    const MemoryReport& memory = candidate.renderer->plan().memory;
                    held += memory.transient + memory.persistent;
                    if (held > sweepMemory) candidate.renderer.reset();
                }
                candidates.push_back(std::move(candidate));
            }
            tell(scene.name + ": " + point.name, true);
        }
        for (int round = 0; round < sweep_.repeats; ++round) runRound(unit, scene, candidates, round);
    }

    void runRound(const SweepUnit& unit, const SweepScene& scene, std::vector<Candidate>& candidates,
                  int round) {
        std::optional<SpinTest> spin; // of a round in which there is something to do
        for (Candidate& candidate : candidates) {
            const std::string what = fmt::format("{}: {}, repetition {} of {}", scene.name,
                                                 candidate.point->name, round + 1, sweep_.repeats);
            if (!folder_.hasTurn(unit, *candidate.point, round)) {
                if (!spin) spin = measureSpin();
                SweepRepetition repetition{round, machine_.id, spin->oneThreadMs, spin->twoThreadsMs,
                                           timeTurn(candidate)};
                folder_.write(unit, *candidate.point, repetition);
            }
            tell(what, true);
        }
    }

    // ---- renderers

    // The unit's scene under a setup. Graphs seldom set it up differently: the last one is kept.
    const Scene& sceneUnder(const SceneSetup& setup) {
        std::string text = setupText(setup);
        if (loadedSetup_ == text) return loaded_;
        loaded_ = loadScene(scene_->source, sweepFolder(), {.allowOutside = sweep_.allowOutside}, setup);
        for (const std::string& warning : loaded_.warnings)
            if (warned_.insert(scene_->name + warning).second) logWarning("{}: {}", scene_->name, warning);
        loadedSetup_ = std::move(text);
        return loaded_;
    }

    [[nodiscard]] std::filesystem::path sweepFolder() const {
        return sweep_.file.has_parent_path() ? sweep_.file.parent_path() : ".";
    }

    [[nodiscard]] std::unique_ptr<Renderer> open(const std::string& graphName,
                                                 const std::vector<SweepSetting>& settings,
                                                 const std::vector<PortRef>& outputs, const Location& where) {
        RenderOptions options;
        options.size = sweep_.size;
        options.seed = sweep_.seed;
        options.timing = true;
        options.finishFrames = true;
        Graph graph = sweepGraph(sweep_, graphName, settings, outputs, registry_, where);
        // As renderCommand() has it: what the sweep says of the scene counts before what the graph says.
        graph.sceneSetup = joined(located(std::move(graph.sceneSetup), graph.file.parent_path()),
                                  located(scene_->setup, sweepFolder()));
        const Scene& scene = sceneUnder(graph.sceneSetup);
        auto renderer =
            std::make_unique<Renderer>(std::move(graph), registry_, scene, context_.capabilities(), options);
        renderer->setPaused(!sweep_.moving);
        return renderer;
    }

    // When the last frame of a moving picture is.
    [[nodiscard]] double timeOfPicture(const Renderer& renderer) const {
        const Scene& scene = renderer.scene();
        double time = scene.startTime;
        for (int i = 1; i < sweep_.frames; ++i)
            time = timeAfter(time, renderer.facts().duration, 1 / scene.frameRate);
        return time;
    }

    [[nodiscard]] std::unique_ptr<Renderer> open(const SweepPoint& point) {
        std::vector<PortRef> outputs{point.output};
        if (point.ray) outputs.push_back(sweep_.rays->rays);
        return open(point.graph, point.settings, outputs, point.where);
    }

    static std::map<std::string, double> reportsOf(const Renderer& renderer) {
        std::map<std::string, double> reports;
        for (const auto& [pass, values] : renderer.last().values)
            for (const auto& [key, value] : values) reports[pass + "." + key] = value;
        return reports;
    }

    // ---- the reference

    void takeReference(const SweepScene& scene) {
        referenceRecord_ = folder_.reference(scene).value_or(SweepReferenceRecord{});
        const bool known = folder_.reference(scene).has_value();
        const auto file = [&](const char* ending) {
            return folder_.path() / folder_.referenceName(scene, ending);
        };
        reference_ = mask_ = Image();
        distances_.clear();
        if (known) {
            if (sweep_.reference) reference_ = readImage(file(".exr"));
            if (sweep_.reference && sweep_.reference->mask) mask_ = readImage(file(".mask.exr"));
            if (sweep_.rays) {
                const std::vector<std::byte> bytes = readBytes(file(".hits"));
                distances_.resize(bytes.size() / sizeof(float));
                if (!distances_.empty())
                    std::memcpy(distances_.data(), bytes.data(), distances_.size() * sizeof(float));
            }
            return;
        }
        if (sweep_.reference) {
            renderReference(scene);
            writeImage(file(".exr"), reference_, Encoding::Linear);
            if (!mask_.empty()) writeImage(file(".mask.exr"), mask_, Encoding::Linear);
            referenceRecord_.picture = folder_.referenceName(scene, ".png");
            writePicture(folder_.path() / referenceRecord_.picture, reference_, sweep_.hdr,
                         referenceRecord_.exposure);
        }
        if (sweep_.rays) {
            traceReference(scene);
            writeFile(file(".hits"), std::as_bytes(std::span(distances_)));
        }
        folder_.write(scene, referenceRecord_); // last: it says that the others are whole
    }

    void renderReference(const SweepScene& scene) {
        const SweepReference& asked = *sweep_.reference;
        tell(scene.name + ": the reference", false);
        std::vector<PortRef> outputs{asked.output};
        if (asked.mask) outputs.push_back(*asked.mask);
        const auto renderer = open(asked.graph, asked.settings, outputs, asked.where);
        renderer->setPaused(true);
        if (sweep_.moving) renderer->setTime(timeOfPicture(*renderer));
        for (int i = 0; i < asked.frames; ++i) static_cast<void>(renderer->frame());
        reference_ = renderer->read(asked.output);
        if (asked.mask) mask_ = convertChannels(renderer->read(*asked.mask), 1);
        if (blankMask())
            logWarning("{}: the mask {} is 0 everywhere: no pixel counts, and nothing here has an error",
                       scene.name, asked.mask->text());
        referenceRecord_.nothingCounts = blankMask();
        referenceRecord_.exposure = sweep_.hdr ? exposureFor(reference_) : 1;
        referenceRecord_.reports = reportsOf(*renderer);
        const auto noise = referenceRecord_.reports.find(asked.output.pass + ".noise");
        if (noise != referenceRecord_.reports.end()) referenceRecord_.noise = noise->second;
    }

    [[nodiscard]] bool blankMask() const {
        return !mask_.empty() && std::ranges::none_of(mask_.values, [](float value) { return value > 0.5F; });
    }

    void traceReference(const SweepScene& scene) {
        const SweepRays& asked = *sweep_.rays;
        tell(scene.name + ": the reference's rays", false);
        const auto renderer = open(asked.graph, asked.settings, {asked.hits, asked.rays}, asked.where);
        for (int i = 0; i < asked.frames; ++i) static_cast<void>(renderer->frame());
        const std::vector<std::byte> rays = renderer->readBytes(asked.rays);
        distances_ = hitDistances(renderer->readBytes(asked.hits), rays);
        const SweepRayFigures figures = compareHits(rays, distances_, distances_);
        referenceRecord_.rays = figures.rays;
        referenceRecord_.hitShare = figures.hitShare;
        referenceRecord_.raysHash = bytesHash(rays);
    }

    // ---- pictures

    // False if it failed. A renderer is left in the candidate where it was needed.
    bool measurePicture(const SweepUnit& unit, Candidate& candidate) {
        const SweepPoint& point = *candidate.point;
        if (const auto held = folder_.picture(unit, point)) {
            if (!held->failed.empty()) return false;
            candidate.renderer = open(point);
            static_cast<void>(candidate.renderer->frame());
            return true;
        }
        SweepPicture picture;
        picture.machine = machine_.id;
        try {
            makePicture(unit, candidate, picture);
        } catch (const Error& error) {
            picture = {};
            picture.machine = machine_.id;
            picture.failed = messageOf(error);
            candidate.renderer.reset();
        }
        folder_.write(unit, point, picture);
        return picture.failed.empty();
    }

    void makePicture(const SweepUnit& unit, Candidate& candidate, SweepPicture& picture) {
        const SweepPoint& point = *candidate.point;
        const auto start = SweepClock::now();
        candidate.renderer = open(point);
        Renderer& renderer = *candidate.renderer;
        static_cast<void>(renderer.frame());
        picture.setUpMs = msSince(start);
        for (int i = 1; i < point.frames; ++i) static_cast<void>(renderer.frame());
        picture.compileMs = renderer.compileMs();
        picture.transient = renderer.plan().memory.transient;
        picture.unshared = renderer.plan().memory.unshared;
        picture.persistent = renderer.plan().memory.persistent;
        picture.leftOut = renderer.plan().leftOut;
        picture.reports = reportsOf(renderer);
        if (point.ray)
            compareRays(renderer, point, picture);
        else
            compareImage(renderer, unit, point, picture);
    }

    void compareRays(Renderer& renderer, const SweepPoint& point, SweepPicture& picture) {
        const std::vector<std::byte> rays = renderer.readBytes(sweep_.rays->rays);
        if (bytesHash(rays) != referenceRecord_.raysHash)
            throw InputError(point.where,
                             "traces other rays than the reference: graph, settings or frames that make "
                             "the rays differ");
        picture.rays = compareHits(rays, hitDistances(renderer.readBytes(point.output), rays), distances_);
    }

    void compareImage(Renderer& renderer, const SweepUnit& unit, const SweepPoint& point,
                      SweepPicture& picture) {
        const Image image = renderer.read(point.output);
        picture.picture = folder_.pictureName(unit, point);
        writePicture(folder_.path() / picture.picture, image, sweep_.hdr, referenceRecord_.exposure);
        if (referenceRecord_.nothingCounts) return;
        Image map;
        const ErrorFigures figures = measureError(
            reference_, image, {.hdr = sweep_.hdr, .mask = mask_.empty() ? nullptr : &mask_}, &map);
        picture.errors = SweepErrors{figures.mse, figures.ssim, figures.flip.mean, std::nullopt};
        if (std::isfinite(figures.psnr)) picture.errors->psnr = figures.psnr;
        picture.heatMap = folder_.heatMapName(unit, point);
        writeImage(folder_.path() / picture.heatMap, heatMap(map), Encoding::Linear);
    }

    // ---- times

    std::vector<SweepFrame> timeTurn(Candidate& candidate) {
        std::unique_ptr<Renderer> own;
        if (!candidate.renderer) own = open(*candidate.point);
        Renderer& renderer = own ? *own : *candidate.renderer;
        // A renderer that was just made has everything to build in its first frame.
        const int warmUp = sweep_.warmUp + (own && sweep_.warmUp == 0 ? 1 : 0);
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

    void nextFrame(Renderer& renderer) const {
        if (sweep_.rebuild) renderer.restart();
        static_cast<void>(renderer.frame());
    }

    const Sweep& sweep_;
    const std::vector<SweepPoint>& points_;
    const Registry& registry_;
    gl::Context& context_;
    const SweepMachine& machine_;
    const SweepFolder& folder_;
    std::function<void(double, const std::string&)> progress_;
    int work_ = 1, done_ = 0;

    const SweepScene* scene_ = nullptr; // of the unit
    Scene loaded_;
    std::optional<std::string> loadedSetup_; // of loaded_
    std::set<std::string> warned_;
    SweepReferenceRecord referenceRecord_;
    Image reference_, mask_;
    std::vector<float> distances_; // of the reference's hits
};

} // namespace

void runSweep(const Sweep& sweep, const std::vector<SweepPoint>& points, const std::vector<SweepUnit>& units,
              const Registry& registry, gl::Context& context, const SweepMachine& machine,
              const SweepFolder& folder, const SweepOptions& options) {
    folder.write(machine);
    SweepRunner(sweep, points, registry, context, machine, folder).run(units, options);
}

} // namespace kestrel
