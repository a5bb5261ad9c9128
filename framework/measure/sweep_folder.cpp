// The folder that a sweep's results live in.
#include "core/files.h"
#include "measure/sweep_manifest.h"
#include "measure/sweep_results.h"
#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace kestrel {
namespace {

namespace fs = std::filesystem;

bool isThere(const fs::path& file) {
    std::error_code ignored;
    return fs::exists(file, ignored);
}

// Files of a folder and those below, relative to it, sorted: what is done with them has a fixed order.
std::vector<fs::path> filesBelow(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code failure;
    for (fs::recursive_directory_iterator at(folder, failure), end; !failure && at != end;
         at.increment(failure))
        if (at->is_regular_file()) files.push_back(fs::relative(at->path(), folder));
    std::ranges::sort(files);
    return files;
}

} // namespace

SweepFolder::SweepFolder(fs::path folder, const Sweep& sweep)
    : folder_(std::move(folder))
    , sweep_(sweep) {}

void SweepFolder::begin(bool resume, const SweepMachine* machine) const {
    const Location where{folder_.string()};
    const SweepManifest now(sweep_, machine != nullptr ? machine->id : "several");
    std::optional<SweepManifest> held = SweepManifest::read(folder_);
    if (!held) {
        if (isThere(folder_) && !fs::is_directory(folder_)) throw InputError(where, "is not a folder");
        now.write(folder_);
        return;
    }
    if (!resume)
        throw InputError(where,
                         "holds results already: --resume goes on with them; else name another folder");
    refuseChanges(*held, now);
    if (machine != nullptr && held->machine() != machine->id)
        throw InputError(
            where,
            fmt::format("holds times of {}, and this is machine {}: times compare within "
                        "one machine only; measure into another folder and join both with "
                        "--merge",
                        held->machine() == "several" ? "several machines" : "machine " + held->machine(),
                        machine->id));
    held->add(now);
    held->write(folder_);
}

void SweepFolder::refuseChanges(const SweepManifest& held, const SweepManifest& now) const {
    std::vector<Problem> problems;
    for (const std::string& cause : held.changes(now))
        problems.push_back({Location{folder_.string()}, fmt::format("was measured otherwise: {}", cause)});
    if (problems.empty()) return;
    problems.push_back({Location{folder_.string()},
                        fmt::format("its results cannot be kept for {}: measure into another folder, or "
                                    "remove this one",
                                    sweep_.file.filename().string())});
    throw InputError(std::move(problems));
}

fs::path SweepFolder::pointFolder(const SweepUnit& unit, const SweepPoint& point) const {
    return folder_ / "parts" / unit.slug / point.slug;
}

std::string SweepFolder::pictureName(const SweepUnit& unit, const SweepPoint& point) const {
    return fmt::format("pictures/{}/{}.png", unit.slug, point.slug);
}

std::string SweepFolder::heatMapName(const SweepUnit& unit, const SweepPoint& point) const {
    return fmt::format("pictures/{}/{}.flip.png", unit.slug, point.slug);
}

std::string SweepFolder::referenceName(const SweepScene& scene, const std::string& ending) const {
    return fmt::format("{}/references/{}{}", ending == ".png" ? "pictures" : "parts", scene.slug, ending);
}

std::optional<SweepReferenceRecord> SweepFolder::reference(const SweepScene& scene) const {
    const fs::path file = folder_ / referenceName(scene, ".json");
    if (!isThere(file)) return std::nullopt;
    return referenceRecordOf(readText(file), file.string());
}

std::optional<SweepPicture> SweepFolder::picture(const SweepUnit& unit, const SweepPoint& point) const {
    const fs::path file = pointFolder(unit, point) / "picture.json";
    if (!isThere(file)) return std::nullopt;
    return pictureOf(readText(file), file.string());
}

bool SweepFolder::hasTurn(const SweepUnit& unit, const SweepPoint& point, int round) const {
    return isThere(pointFolder(unit, point) / fmt::format("repetition-{}.json", round));
}

std::vector<SweepRepetition> SweepFolder::repetitions(const SweepUnit& unit, const SweepPoint& point) const {
    std::vector<SweepRepetition> result;
    for (int round = 0; round < sweep_.repeats; ++round) {
        if (!hasTurn(unit, point, round)) continue;
        const fs::path file = pointFolder(unit, point) / fmt::format("repetition-{}.json", round);
        result.push_back(repetitionOf(readText(file), file.string()));
    }
    return result;
}

void SweepFolder::write(const SweepScene& scene, const SweepReferenceRecord& record) const {
    writeFile(folder_ / referenceName(scene, ".json"), partText(record));
}

void SweepFolder::write(const SweepUnit& unit, const SweepPoint& point, const SweepPicture& picture) const {
    writeFile(pointFolder(unit, point) / "picture.json", partText(picture));
}

void SweepFolder::write(const SweepUnit& unit, const SweepPoint& point,
                        const SweepRepetition& repetition) const {
    writeFile(pointFolder(unit, point) / fmt::format("repetition-{}.json", repetition.round),
              partText(repetition));
}

void SweepFolder::write(const SweepMachine& machine) const {
    writeFile(folder_ / "parts" / "machines" / (machine.id + ".json"), partText(machine));
}

void SweepFolder::merge(const SweepFolder& other) const {
    const Location where{other.folder_.string()};
    const std::optional<SweepManifest> theirs = SweepManifest::read(other.folder_);
    if (!theirs) throw InputError(where, "holds no results of a sweep");
    SweepManifest mine = SweepManifest::read(folder_).value();
    other.refuseChanges(*theirs, mine);
    mine.add(*theirs);
    mine.write(folder_);
    const auto shared = [](const fs::path& file) { // the same in every shard that needs it
        const std::string text = file.generic_string();
        return text.starts_with("references/") || text.starts_with("machines/");
    };
    for (const char* part : {"parts", "pictures"})
        for (const fs::path& file : filesBelow(other.folder_ / part)) {
            const fs::path target = folder_ / part / file;
            if (isThere(target) && shared(file)) continue;
            if (isThere(target))
                throw InputError(where,
                                 fmt::format("holds {} which another of the folders to be joined holds too",
                                             (fs::path(part) / file).string()));
            const std::vector<std::byte> bytes = readBytes(other.folder_ / part / file);
            writeFile(target, bytes);
        }
}

SweepResults SweepFolder::gather(const std::vector<SweepPoint>& points,
                                 const std::vector<SweepUnit>& units) const {
    SweepResults results;
    if (const auto manifest = SweepManifest::read(folder_)) results.hash = manifest->hash();
    for (const fs::path& file : filesBelow(folder_ / "parts" / "machines")) {
        const fs::path full = folder_ / "parts" / "machines" / file;
        results.machines.push_back(machineOf(readText(full), full.string()));
    }
    for (const SweepScene& scene : sweep_.scenes)
        if (auto found = reference(scene)) results.references.emplace(scene.name, std::move(*found));
    std::set<std::pair<double, double>> spins;
    for (const SweepUnit& unit : units) {
        const SweepScene& scene = sweep_.scenes[static_cast<size_t>(unit.scene)];
        for (const int index : unit.points) {
            const SweepPoint& point = points[static_cast<size_t>(index)];
            auto held = picture(unit, point);
            const std::vector<SweepRepetition> times = repetitions(unit, point);
            if (!held || (held->failed.empty() && times.empty())) {
                results.missing.push_back(scene.name + ": " + point.name);
                continue;
            }
            SweepRow row;
            row.scene = scene.name;
            row.camera = cameraOf(scene);
            row.point = point.name;
            row.variant = point.variant;
            row.series = point.series;
            row.along = point.along;
            row.plot = point.plot;
            row.axes = point.axes;
            row.tunedOf = point.tunedOf;
            row.ray = point.ray;
            row.picture = std::move(*held);
            if (const auto found = results.references.find(scene.name);
                found != results.references.end() && !point.ray)
                row.referenceNoise = found->second.noise;
            addTimes(row, sweep_, times);
            if (row.machine.empty()) row.machine = row.picture.machine;
            for (const SweepRepetition& repetition :
                 times) // one spin test a round stands in every repetition of it
                if (spins.emplace(repetition.spinOne, repetition.spinTwo).second)
                    results.spins[repetition.machine].emplace_back(repetition.spinOne, repetition.spinTwo);
            row.command = renderCommand(sweep_, scene, point);
            row.timesCommand = timesCommand(sweep_, point);
            results.rows.push_back(std::move(row));
        }
    }
    markPareto(results.rows, sweep_);
    return results;
}

void SweepFolder::writeResults(const SweepResults& results) const {
    const std::string json = resultsJson(sweep_, results);
    writeFile(folder_ / "results.json", json);
    writeFile(folder_ / "results.md", resultsMarkdown(json, "results.json"));
    writeFile(folder_ / "results.csv", resultsCsv(sweep_, results));
    writeFile(folder_ / "index.html", resultsPage(sweep_, results));
}

} // namespace kestrel
