#include "measure/tune/tune_run.h"
#include "core/log.h"
#include "gl/context.h"
#include "measure/sweep_stage.h"
#include "measure/tune/tune_folder.h"
#include "measure/tune/tune_space.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace kestrel {
namespace {

// Tuning comes first in a run's progress; what remains is judging.
constexpr double tuningShare = 0.8;

// A training scene: made when something is to be measured on it.
class TrainingScene {
public:
    TrainingScene(const SweepRun& run, const SweepScene& scene)
        : run_(run)
        , scene_(scene) {}

    [[nodiscard]] const SweepScene& scene() const { return scene_; }
    SweepStage& stage() {
        if (!stage_) stage_.emplace(run_, scene_);
        return *stage_;
    }

    // The point's error; nothing where no pixel counts.
    std::optional<double> error(const SweepPoint& point) {
        Renderer& renderer = changed(candidate_, point);
        try {
            for (int i = 0; i < point.frames; ++i) static_cast<void>(renderer.frame());
            SweepRow row;
            row.ray = point.ray;
            const SweepComparison comparison =
                stage().compare(renderer, point, nullptr, run_.sweep.plotError);
            row.picture.errors = comparison.errors;
            row.picture.rays = comparison.rays;
            return errorOf(row, run_.sweep.plotError);
        } catch (...) {
            candidate_.reset(); // in whatever state it is
            throw;
        }
    }

    // Medians of the plot's time, of both in turn: milliseconds.
    std::pair<double, double> times(const SweepPoint& plain, const SweepPoint& point) {
        Renderer& first = changed(default_, plain);
        Renderer& second = changed(candidate_, point);
        for (Renderer* renderer : {&first, &second}) static_cast<void>(renderer->frame());
        std::vector<SweepRepetition> ofFirst, ofSecond;
        for (int round = 0; round < run_.sweep.repeats; ++round) {
            ofFirst.push_back({round, "", 0, 0, stage().timeTurn(first, false)});
            ofSecond.push_back({round, "", 0, 0, stage().timeTurn(second, false)});
        }
        return {median(ofFirst), median(ofSecond)};
    }

    void forget() {
        candidate_.reset();
        default_.reset();
    }

private:
    Renderer& changed(std::unique_ptr<Renderer>& renderer, const SweepPoint& point) {
        if (renderer)
            stage().change(*renderer, point);
        else
            renderer = stage().open(point);
        return *renderer;
    }

    [[nodiscard]] double median(const std::vector<SweepRepetition>& repetitions) const {
        SweepRow row;
        addTimes(row, run_.sweep, repetitions);
        const auto found = row.ms.find(run_.sweep.plotTime);
        return found == row.ms.end() ? 0 : found->second.median;
    }

    const SweepRun& run_;
    const SweepScene& scene_;
    std::optional<SweepStage> stage_;
    std::unique_ptr<Renderer> default_, candidate_; // of the point that is being tuned
};

// Tunes one point.
class PointTuner {
public:
    PointTuner(const SweepRun& run, const SweepMachine& machine, std::vector<TrainingScene>& scenes,
               const SweepPoint& point)
        : run_(run)
        , machine_(machine)
        , scenes_(scenes)
        , point_(point)
        , space_(tuneSpace(run.sweep, point, run.registry))
        , folder_(run.folder, point)
        , start_(space_.settings(space_.start)) {}

    // At most so many settings are asked for.
    [[nodiscard]] int most() const {
        const SweepTuning& tuning = *run_.sweep.tuning;
        int round = 0;
        for (const TuneAxis& axis : space_.axes) round += axis.choices > 0 ? axis.choices : tuning.steps;
        return 1 + tuning.probes + tuning.rounds * round;
    }

    void run(const std::function<void(int asked, const std::string& what)>& progress) {
        const SweepTuning& tuning = *run_.sweep.tuning;
        TuneEffort effort{tuning.steps, tuning.rounds, tuning.probes};
        effort.seed = run_.sweep.seed;
        int asked = 0;
        const TuneFound found =
            searchTuning(space_.axes, space_.start, effort,
                         {[&](const TuneSetting& setting, double bound) {
                              progress(asked++, point_.name);
                              return error(space_.settings(setting), bound);
                          },
                          [&](const TuneSetting& setting) { return affordable(space_.settings(setting)); }});
        for (TrainingScene& scene : scenes_) scene.forget();
        write(found);
    }

private:
    std::optional<double> error(const TuneSettings& set, double bound) {
        double sum = 0;
        size_t counted = 0;
        for (TrainingScene& scene : scenes_) {
            auto record = folder_.error(scene.scene(), set);
            if (!record) {
                record = TuneErrorRecord{set, machine_.id, "", std::nullopt};
                try {
                    record->error = scene.error(withSettings(point_, set));
                } catch (const Error& error) {
                    record->failed = sweepMessage(error);
                }
                folder_.write(scene.scene(), *record);
            }
            if (!record->failed.empty() && set == start_)
                logWarning("{}: {}: the default fails: {}", scene.scene().name, point_.name, record->failed);
            if (!record->failed.empty()) return std::nullopt;
            if (!record->error) continue;
            sum += *record->error;
            ++counted;
            // Errors are not negative: it is the mean over all scenes at least.
            if (sum / static_cast<double>(scenes_.size()) >= bound) return std::nullopt;
        }
        return counted > 0 ? std::optional(sum / static_cast<double>(counted)) : std::nullopt;
    }

    bool affordable(const TuneSettings& set) {
        const SweepTuning& tuning = *run_.sweep.tuning;
        const TuneTimeRecord times = timesOf(set);
        if (tuning.mostMs) return times.ms <= *tuning.mostMs * static_cast<double>(scenes_.size());
        return times.ms <= tuning.mostTime * times.defaultMs;
    }

    TuneTimeRecord timesOf(const TuneSettings& set) {
        if (auto held = folder_.time(set)) return *held;
        TuneTimeRecord record{set, machine_.id};
        for (TrainingScene& scene : scenes_) {
            run_.tell(fmt::format("{}: {}: times", scene.scene().name, point_.name));
            const auto [plain, own] = scene.times(point_, withSettings(point_, set));
            record.defaultMs += plain;
            record.ms += own;
        }
        folder_.write(record);
        return record;
    }

    void write(const TuneFound& found) {
        if (!std::isfinite(found.startError)) return; // the default fails, or nothing counts
        TuneOutcome outcome;
        outcome.start = start_;
        outcome.set = space_.settings(found.setting);
        outcome.startError = found.startError;
        outcome.error = found.error;
        outcome.asked = found.asked;
        outcome.tooSlow = found.tooSlow;
        if (outcome.set != outcome.start)
            if (const auto times = folder_.time(outcome.set); times && times->defaultMs > 0)
                outcome.timeRatio = times->ms / times->defaultMs;
        for (const TuneStep& step : found.path)
            outcome.path.push_back({step.round,
                                    step.axis < 0 ? "" : space_.names[static_cast<size_t>(step.axis)],
                                    space_.settings(step.setting), step.error});
        folder_.write(outcome);
    }

    const SweepRun& run_;
    const SweepMachine& machine_;
    std::vector<TrainingScene>& scenes_;
    const SweepPoint& point_;
    TuneSpace space_;
    TuneFolder folder_;
    TuneSettings start_;
};

// The training scenes in the order of the file.
std::vector<TrainingScene> trainingScenes(const SweepRun& run) {
    std::vector<TrainingScene> scenes;
    for (const SweepScene& scene : run.sweep.scenes)
        if (std::ranges::find(run.sweep.tuning->train, scene.name) != run.sweep.tuning->train.end())
            scenes.emplace_back(run, scene);
    return scenes;
}

} // namespace

void runTuning(const Sweep& sweep, const std::vector<SweepPoint>& points, const Registry& registry,
               gl::Context& context, const SweepMachine& machine, const SweepFolder& folder,
               const SweepOptions& options) {
    folder.write(machine);
    double done = 0;
    const auto tell = [&](double fraction, const std::string& what) {
        if (options.progress) options.progress(fraction, what);
    };
    const SweepRun run{sweep, registry, context, folder,
                       [&](const std::string& what) { tell(tuningShare * done, what); }};
    std::vector<size_t> own;
    for (size_t i = 0; i < points.size(); ++i)
        if (options.shard.has(i) && (options.chosen.empty() || options.chosen[i])) own.push_back(i);
    {
        std::vector<TrainingScene> scenes = trainingScenes(run);
        std::vector<SweepPoint> open;
        for (const size_t i : own)
            if (!points[i].free.empty() && !TuneFolder(folder, points[i]).outcome())
                open.push_back(points[i]);
        for (size_t i = 0; i < open.size(); ++i) {
            PointTuner tuner(run, machine, scenes, open[i]);
            tuner.run([&](int asked, const std::string& what) {
                done = (static_cast<double>(i) + asked / static_cast<double>(tuner.most())) /
                       static_cast<double>(open.size());
                run.tell(fmt::format("{}, setting {}", what, asked + 1));
            });
        }
    }
    const std::vector<SweepPoint> judged = judgedPoints(points, folder);
    SweepOptions judging;
    for (const SweepPoint& point : judged) {
        const std::string& name = point.tunedOf.empty() ? point.name : point.tunedOf;
        judging.chosen.push_back(std::ranges::any_of(own, [&](size_t i) { return points[i].name == name; }));
    }
    judging.progress = [&](double fraction, const std::string& what) {
        tell(tuningShare + (1 - tuningShare) * fraction, what);
    };
    runSweep(sweep, judged, sweepUnits(sweep, judged), registry, context, machine, folder, judging);
}

} // namespace kestrel
