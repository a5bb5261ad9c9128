#include "measure/sweep_run.h"
#include "core/spin.h"
#include "gl/context.h"
#include "image/colormap.h"
#include "image/io.h"
#include "measure/sweep_stage.h"
#include <algorithm>
#include <chrono>
#include <fmt/format.h>

namespace kestrel {
namespace {

using SweepClock = std::chrono::steady_clock;

// Renderers stay alive between their repetitions while what they hold together is less; the others are made
// anew for each repetition.
constexpr std::uint64_t sweepMemory = std::uint64_t{6} << 30;

double msSince(SweepClock::time_point start) {
    return std::chrono::duration<double, std::milli>(SweepClock::now() - start).count();
}

class SweepRunner {
public:
    SweepRunner(const Sweep& sweep, const std::vector<SweepPoint>& points, const Registry& registry,
                gl::Context& context, const SweepMachine& machine, const SweepFolder& folder)
        : sweep_(sweep)
        , points_(points)
        , machine_(machine)
        , folder_(folder)
        , shared_{sweep, registry, context, folder, [this](const std::string& what) { tell(what, false); }} {}

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
        SweepStage stage(shared_, scene);

        std::vector<Candidate> candidates;
        std::uint64_t held = 0;
        for (const int index : chosen) {
            const SweepPoint& point = points_[static_cast<size_t>(index)];
            tell(scene.name + ": " + point.name, false);
            Candidate candidate{&point, nullptr};
            if (measurePicture(stage, unit, candidate)) {
                if (candidate.renderer) {
                    const MemoryReport& memory = candidate.renderer->plan().memory;
                    held += memory.transient + memory.persistent;
                    if (held > sweepMemory) candidate.renderer.reset();
                }
                candidates.push_back(std::move(candidate));
            }
            tell(scene.name + ": " + point.name, true);
        }
        for (int round = 0; round < sweep_.repeats; ++round) runRound(stage, unit, candidates, round);
    }

    void runRound(SweepStage& stage, const SweepUnit& unit, std::vector<Candidate>& candidates, int round) {
        std::optional<SpinTest> spin; // of a round in which there is something to do
        for (Candidate& candidate : candidates) {
            const std::string what = fmt::format("{}: {}, repetition {} of {}", stage.scene().name,
                                                 candidate.point->name, round + 1, sweep_.repeats);
            if (!folder_.hasTurn(unit, *candidate.point, round)) {
                if (!spin) spin = measureSpin();
                std::unique_ptr<Renderer> own;
                if (!candidate.renderer) own = stage.open(*candidate.point);
                SweepRepetition repetition{round, machine_.id, spin->oneThreadMs, spin->twoThreadsMs,
                                           stage.timeTurn(own ? *own : *candidate.renderer, own != nullptr)};
                folder_.write(unit, *candidate.point, repetition);
            }
            tell(what, true);
        }
    }

    // ---- pictures

    // False if it failed. A renderer is left in the candidate where it was needed.
    bool measurePicture(SweepStage& stage, const SweepUnit& unit, Candidate& candidate) {
        const SweepPoint& point = *candidate.point;
        if (const auto held = folder_.picture(unit, point)) {
            if (!held->failed.empty()) return false;
            candidate.renderer = stage.open(point);
            static_cast<void>(candidate.renderer->frame());
            return true;
        }
        SweepPicture picture;
        picture.machine = machine_.id;
        try {
            makePicture(stage, unit, candidate, picture);
        } catch (const Error& error) {
            picture = {};
            picture.machine = machine_.id;
            picture.failed = sweepMessage(error);
            candidate.renderer.reset();
        }
        folder_.write(unit, point, picture);
        return picture.failed.empty();
    }

    void makePicture(SweepStage& stage, const SweepUnit& unit, Candidate& candidate, SweepPicture& picture) {
        const SweepPoint& point = *candidate.point;
        const auto start = SweepClock::now();
        candidate.renderer = stage.open(point);
        Renderer& renderer = *candidate.renderer;
        static_cast<void>(renderer.frame());
        picture.setUpMs = msSince(start);
        for (int i = 1; i < point.frames; ++i) static_cast<void>(renderer.frame());
        picture.compileMs = renderer.compileMs();
        picture.transient = renderer.plan().memory.transient;
        picture.unshared = renderer.plan().memory.unshared;
        picture.persistent = renderer.plan().memory.persistent;
        picture.leftOut = renderer.plan().leftOut;
        picture.reports = sweepReports(renderer);
        Image map;
        const SweepComparison comparison = stage.compare(renderer, point, &map);
        picture.rays = comparison.rays;
        picture.errors = comparison.errors;
        if (point.ray) return;
        const Image image = renderer.read(point.output);
        picture.picture = folder_.pictureName(unit, point);
        writeSweepPicture(folder_.path() / picture.picture, image, sweep_.hdr, stage.reference().exposure);
        if (!point.exact.empty()) picture.split = stage.split(point, image);
        if (!picture.errors) return;
        picture.heatMap = folder_.heatMapName(unit, point);
        writeImage(folder_.path() / picture.heatMap, heatMap(map), Encoding::Linear);
    }

    const Sweep& sweep_;
    const std::vector<SweepPoint>& points_;
    const SweepMachine& machine_;
    const SweepFolder& folder_;
    SweepRun shared_;
    std::function<void(double, const std::string&)> progress_;
    int work_ = 1, done_ = 0;
};

} // namespace

void runSweep(const Sweep& sweep, const std::vector<SweepPoint>& points, const std::vector<SweepUnit>& units,
              const Registry& registry, gl::Context& context, const SweepMachine& machine,
              const SweepFolder& folder, const SweepOptions& options) {
    folder.write(machine);
    SweepRunner(sweep, points, registry, context, machine, folder).run(units, options);
}

} // namespace kestrel
