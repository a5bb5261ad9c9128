#include "measure/tune/tune_folder.h"
#include "core/files.h"
#include "core/hash.h"
#include "measure/tune/tune_space.h"
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace kestrel {
namespace {

using TuneJson = nlohmann::ordered_json;

std::string tuneDump(const TuneJson& json) {
    return json.dump(1, ' ', false, TuneJson::error_handler_t::replace) + "\n";
}

// Reads a file that may be absent. What is damaged is told, as with a sweep's parts.
template<class Record, class Read>
std::optional<Record> readTuned(const std::filesystem::path& file, Read&& read) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return std::nullopt;
    try {
        const TuneJson json = TuneJson::parse(readText(file));
        Record record;
        read(json, record);
        return record;
    } catch (const TuneJson::exception&) {
        throw InputError(Location{file.string()}, "is damaged: remove it, and --resume measures it again");
    }
}

// Of two settings whose names' hashes agree only one is kept.
template<class Record>
std::optional<Record> ofSetting(std::optional<Record> record, const TuneSettings& set) {
    return record && record->set == set ? std::move(record) : std::nullopt;
}

} // namespace

TuneFolder::TuneFolder(const SweepFolder& folder, const SweepPoint& point)
    : folder_(folder.path() / "parts" / "tuning" / point.slug) {}

std::filesystem::path TuneFolder::fileOf(const TuneSettings& set, const std::string& what) const {
    Fnv1a hash;
    for (const std::string& setting : set) hash.add(setting + "\n");
    return folder_ / fmt::format("{:016x}.{}.json", hash.value(), what);
}

std::optional<TuneErrorRecord> TuneFolder::error(const SweepScene& scene, const TuneSettings& set) const {
    return ofSetting(readTuned<TuneErrorRecord>(fileOf(set, "error-" + scene.slug),
                                                [](const TuneJson& json, TuneErrorRecord& record) {
                                                    json.at("set").get_to(record.set);
                                                    json.at("machine").get_to(record.machine);
                                                    json.at("failed").get_to(record.failed);
                                                    if (json.at("error").is_number())
                                                        record.error = json.at("error").get<double>();
                                                }),
                     set);
}

std::optional<TuneTimeRecord> TuneFolder::time(const TuneSettings& set) const {
    return ofSetting(readTuned<TuneTimeRecord>(fileOf(set, "time"),
                                               [](const TuneJson& json, TuneTimeRecord& record) {
                                                   json.at("set").get_to(record.set);
                                                   json.at("machine").get_to(record.machine);
                                                   json.at("default_ms").get_to(record.defaultMs);
                                                   json.at("ms").get_to(record.ms);
                                               }),
                     set);
}

std::optional<TuneOutcome> TuneFolder::outcome() const {
    return readTuned<TuneOutcome>(folder_ / "outcome.json", [](const TuneJson& json, TuneOutcome& outcome) {
        json.at("start").get_to(outcome.start);
        json.at("set").get_to(outcome.set);
        json.at("start_error").get_to(outcome.startError);
        json.at("error").get_to(outcome.error);
        json.at("time_ratio").get_to(outcome.timeRatio);
        json.at("asked").get_to(outcome.asked);
        json.at("too_slow").get_to(outcome.tooSlow);
        for (const TuneJson& step : json.at("path"))
            outcome.path.push_back({step.at("round").get<int>(), step.at("along").get<std::string>(),
                                    step.at("set").get<TuneSettings>(), step.at("error").get<double>()});
    });
}

void TuneFolder::write(const SweepScene& scene, const TuneErrorRecord& record) const {
    writeFile(fileOf(record.set, "error-" + scene.slug),
              tuneDump({{"set", record.set},
                        {"scene", scene.name},
                        {"machine", record.machine},
                        {"failed", record.failed},
                        {"error", record.error ? TuneJson(*record.error) : TuneJson(nullptr)}}));
}

void TuneFolder::write(const TuneTimeRecord& record) const {
    writeFile(fileOf(record.set, "time"), tuneDump({{"set", record.set},
                                                    {"machine", record.machine},
                                                    {"default_ms", record.defaultMs},
                                                    {"ms", record.ms}}));
}

void TuneFolder::write(const TuneOutcome& outcome) const {
    TuneJson path = TuneJson::array();
    for (const TuneOutcome::Step& step : outcome.path)
        path.push_back(
            {{"round", step.round}, {"along", step.along}, {"set", step.set}, {"error", step.error}});
    writeFile(folder_ / "outcome.json", tuneDump({{"start", outcome.start},
                                                  {"set", outcome.set},
                                                  {"start_error", outcome.startError},
                                                  {"error", outcome.error},
                                                  {"time_ratio", outcome.timeRatio},
                                                  {"asked", outcome.asked},
                                                  {"too_slow", outcome.tooSlow},
                                                  {"path", path}}));
}

std::vector<SweepPoint> judgedPoints(const std::vector<SweepPoint>& points, const SweepFolder& folder) {
    std::set<std::string> slugs{"reference"};
    for (const SweepPoint& point : points) slugs.insert(point.slug);
    std::vector<SweepPoint> judged;
    for (const SweepPoint& point : points) {
        judged.push_back(point);
        if (point.free.empty()) continue;
        SweepPoint& plain = judged.back();
        plain.axes.emplace_back("setting", "default");
        plain.along = "setting";
        const auto outcome = TuneFolder(folder, point).outcome();
        // Its file name is taken in any case, so that those of others do not depend on what was found.
        const std::string slug = sweepSlug(point.name + ", tuned", slugs);
        if (!outcome || outcome->set == outcome->start) continue;
        SweepPoint tuned = withSettings(plain, outcome->set);
        tuned.name += ", tuned";
        tuned.tunedOf = point.name;
        tuned.axes.back().second = "tuned";
        tuned.slug = slug;
        judged.push_back(std::move(tuned));
    }
    return judged;
}

} // namespace kestrel
