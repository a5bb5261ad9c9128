// The folder that a sweep's results live in.
#include "core/files.h"
#include "measure/sweep_results.h"
#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <set>

namespace kestrel {
namespace {

namespace fs = std::filesystem;

// First line: the hash of the sweep. Second: the machine, or "several".
constexpr const char* manifestName = "sweep.manifest";

std::vector<std::string> manifestLines(const fs::path& folder) {
    std::ifstream stream(folder / manifestName);
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

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

std::string SweepFolder::heldHash() const {
    const std::vector<std::string> lines = manifestLines(folder_);
    return lines.empty() ? std::string() : lines.front();
}

void SweepFolder::begin(bool resume, const SweepMachine* machine) const {
    const Location where{folder_.string()};
    const std::string hash = sweepHash(sweep_);
    const std::vector<std::string> held = manifestLines(folder_);
    if (!held.empty()) {
        if (!resume)
            throw InputError(where,
                             "holds results already: --resume goes on with them; else name another folder");
        if (held.front() != hash)
            throw InputError(where,
                             fmt::format("holds results of another form of {} (the file, a graph that it "
                                         "names, size, frames or repeats have changed since): measure into "
                                         "another folder, or remove this one",
                                         sweep_.file.filename().string()));
        if (machine != nullptr && held.size() > 1 && held[1] != machine->id)
            throw InputError(where,
                             fmt::format("holds times of {}, and this is machine {}: times compare within "
                                         "one machine only; measure into another folder and join both with "
                                         "--merge",
                                         held[1] == "several" ? "several machines" : "machine " + held[1],
                                         machine->id));
        return;
    }
    if (isThere(folder_) && !fs::is_directory(folder_)) throw InputError(where, "is not a folder");
    writeFile(folder_ / manifestName, hash + "\n" + (machine != nullptr ? machine->id : "several") + "\n");
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
    const std::string hash = other.heldHash();
    if (hash.empty()) throw InputError(where, "holds no results of a sweep");
    if (hash != heldHash())
        throw InputError(where,
                         fmt::format("holds results of another form of {}; only shards of one sweep join",
                                     sweep_.file.filename().string()));
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
    results.hash = heldHash();
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
            row.camera = scene.camera;
            row.point = point.name;
            row.variant = point.variant;
            row.series = point.series;
            row.along = point.along;
            row.plot = point.plot;
            row.axes = point.axes;
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
            row.timesCommand = fmt::format("kestrel sweep {} --size {}x{} --frames {} --only {} --out again",
                                           shellWord(sweep_.file.string()), sweep_.size.width,
                                           sweep_.size.height, sweep_.frames, shellWord(point.name));
            results.rows.push_back(std::move(row));
        }
    }
    markPareto(results.rows, sweep_);
    return results;
}

void SweepFolder::writeResults(const SweepResults& results) const {
    writeFile(folder_ / "results.json", resultsJson(sweep_, results));
    writeFile(folder_ / "results.csv", resultsCsv(sweep_, results));
    writeFile(folder_ / "index.html", resultsPage(sweep_, results));
}

} // namespace kestrel
