// The parts of a sweep's results as JSON text and back.
#include "measure/sweep_results.h"
#include <algorithm>
#include <ctime>
#include <fmt/chrono.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>
#include <unistd.h>

namespace kestrel {
namespace {

using PartJson = nlohmann::ordered_json;

std::string partDump(const PartJson& json) {
    return json.dump(1, ' ', false, PartJson::error_handler_t::replace) + "\n";
}

PartJson optionalJson(const std::optional<double>& value) {
    return value ? PartJson(*value) : PartJson(nullptr);
}

std::optional<double> optionalOf(const PartJson& json) {
    return json.is_number() ? std::optional(json.get<double>()) : std::nullopt;
}

// Parts are our own; a damaged one is told with its name instead of nlohmann's words.
template<class Result, class Read>
Result readPart(const std::string& text, const std::string& file, Read&& read) {
    try {
        const PartJson json = PartJson::parse(text);
        Result result;
        read(json, result);
        return result;
    } catch (const PartJson::exception&) {
        throw InputError(Location{file}, "is damaged: remove it, and --resume measures it again");
    }
}

std::string firstLine(const char* file) {
    std::ifstream stream(file);
    std::string line;
    std::getline(stream, line);
    return line;
}

std::string cpuName() {
    std::ifstream stream("/proc/cpuinfo");
    for (std::string line; std::getline(stream, line);)
        if (line.starts_with("model name"))
            if (const size_t colon = line.find(':'); colon + 2 < line.size()) return line.substr(colon + 2);
    return "unknown";
}

} // namespace

SweepMachine thisMachine(const std::string& renderer, const std::string& driver, const std::string& clock) {
    SweepMachine machine;
    machine.cpu = cpuName();
    machine.threads = static_cast<int>(std::thread::hardware_concurrency());
    machine.renderer = renderer;
    machine.driver = driver;
    machine.clock = clock;
    char host[256] = {};
    static_cast<void>(gethostname(host, sizeof(host) - 1));
    const std::string all = machine.cpu + renderer + driver + clock + host + firstLine("/etc/machine-id") +
                            std::to_string(machine.threads);
    std::uint32_t hash = 0x811c9dc5U; // FNV-1a
    for (const char c : all) hash = (hash ^ static_cast<unsigned char>(c)) * 0x01000193U;
    machine.id = fmt::format("m{:06x}", hash & 0xFFFFFFU);
    machine.date = fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)));
    return machine;
}

std::string partText(const SweepRepetition& repetition) {
    PartJson frames = PartJson::array();
    for (const SweepFrame& frame : repetition.frames) {
        PartJson steps = PartJson::array();
        for (const SweepFrame::Step& step : frame.steps)
            steps.push_back({step.pass, step.step, step.group, step.ms});
        frames.push_back({{"ms", frame.ms}, {"steps", steps}});
    }
    return partDump({{"round", repetition.round},
                     {"machine", repetition.machine},
                     {"spin", {repetition.spinOne, repetition.spinTwo}},
                     {"frames", frames}});
}

SweepRepetition repetitionOf(const std::string& text, const std::string& file) {
    return readPart<SweepRepetition>(text, file, [](const PartJson& json, SweepRepetition& repetition) {
        repetition.round = json.at("round").get<int>();
        repetition.machine = json.at("machine").get<std::string>();
        repetition.spinOne = json.at("spin").at(0).get<double>();
        repetition.spinTwo = json.at("spin").at(1).get<double>();
        for (const PartJson& item : json.at("frames")) {
            SweepFrame frame;
            frame.ms = item.at("ms").get<double>();
            for (const PartJson& step : item.at("steps"))
                frame.steps.push_back({step.at(0).get<std::string>(), step.at(1).get<std::string>(),
                                       step.at(2).get<std::string>(), step.at(3).get<double>()});
            repetition.frames.push_back(std::move(frame));
        }
    });
}

std::string partText(const SweepPicture& picture) {
    PartJson leftOut = PartJson::array();
    for (const LeftOut& item : picture.leftOut) leftOut.push_back({item.what, item.why});
    PartJson json = {{"failed", picture.failed},
                     {"machine", picture.machine},
                     {"compile_ms", picture.compileMs},
                     {"set_up_ms", picture.setUpMs},
                     {"memory", {picture.transient, picture.unshared, picture.persistent}},
                     {"left_out", leftOut},
                     {"reports", picture.reports},
                     {"picture", picture.picture},
                     {"heat_map", picture.heatMap}};
    if (picture.errors)
        json["errors"] = {{"mse", picture.errors->mse},
                          {"psnr", optionalJson(picture.errors->psnr)},
                          {"ssim", picture.errors->ssim},
                          {"flip", picture.errors->flip}};
    if (picture.split)
        json["split"] = {picture.split->mse,   picture.split->representation, picture.split->algorithm,
                         picture.split->cross, picture.split->sampling,       picture.split->referenceNoise};
    if (picture.rays)
        json["rays"] = {{"count", picture.rays->rays},
                        {"hit_share", picture.rays->hitShare},
                        {"agreement", picture.rays->agreement},
                        {"distance_error", optionalJson(picture.rays->distanceError)}};
    return partDump(json);
}

SweepPicture pictureOf(const std::string& text, const std::string& file) {
    return readPart<SweepPicture>(text, file, [](const PartJson& json, SweepPicture& picture) {
        picture.failed = json.at("failed").get<std::string>();
        picture.machine = json.at("machine").get<std::string>();
        picture.compileMs = json.at("compile_ms").get<double>();
        picture.setUpMs = json.at("set_up_ms").get<double>();
        picture.transient = json.at("memory").at(0).get<std::uint64_t>();
        picture.unshared = json.at("memory").at(1).get<std::uint64_t>();
        picture.persistent = json.at("memory").at(2).get<std::uint64_t>();
        for (const PartJson& item : json.at("left_out"))
            picture.leftOut.push_back({item.at(0).get<std::string>(), item.at(1).get<std::string>()});
        picture.reports = json.at("reports").get<std::map<std::string, double>>();
        picture.picture = json.at("picture").get<std::string>();
        picture.heatMap = json.at("heat_map").get<std::string>();
        if (json.contains("errors")) {
            const PartJson& errors = json.at("errors");
            picture.errors = SweepErrors{errors.at("mse").get<double>(), errors.at("ssim").get<double>(),
                                         errors.at("flip").get<double>(), optionalOf(errors.at("psnr"))};
        }
        if (json.contains("split")) {
            const auto part = [&](size_t i) { return json.at("split").at(i).get<double>(); };
            picture.split = ErrorSplit{part(0), part(1), part(2), part(3), part(4), part(5)};
        }
        if (json.contains("rays")) {
            const PartJson& rays = json.at("rays");
            picture.rays =
                SweepRayFigures{rays.at("count").get<double>(), rays.at("hit_share").get<double>(),
                                rays.at("agreement").get<double>(), optionalOf(rays.at("distance_error"))};
        }
    });
}

std::string partText(const SweepReferenceRecord& record) {
    return partDump({{"noise", optionalJson(record.noise)},
                     {"exposure", record.exposure},
                     {"picture", record.picture},
                     {"reports", record.reports},
                     {"hit_share", record.hitShare},
                     {"rays", record.rays},
                     {"rays_hash", record.raysHash},
                     {"nothing_counts", record.nothingCounts}});
}

SweepReferenceRecord referenceRecordOf(const std::string& text, const std::string& file) {
    return readPart<SweepReferenceRecord>(text, file, [](const PartJson& json, SweepReferenceRecord& record) {
        record.noise = optionalOf(json.at("noise"));
        record.exposure = json.at("exposure").get<double>();
        record.picture = json.at("picture").get<std::string>();
        record.reports = json.at("reports").get<std::map<std::string, double>>();
        record.hitShare = json.at("hit_share").get<double>();
        record.rays = json.at("rays").get<double>();
        record.raysHash = json.at("rays_hash").get<std::string>();
        record.nothingCounts = json.value("nothing_counts", false); // older folders do not have it
    });
}

std::string partText(const SweepMachine& machine) {
    return partDump({{"id", machine.id},
                     {"cpu", machine.cpu},
                     {"threads", machine.threads},
                     {"renderer", machine.renderer},
                     {"driver", machine.driver},
                     {"clock", machine.clock},
                     {"version", machine.version},
                     {"date", machine.date}});
}

SweepMachine machineOf(const std::string& text, const std::string& file) {
    return readPart<SweepMachine>(text, file, [](const PartJson& json, SweepMachine& machine) {
        machine.id = json.at("id").get<std::string>();
        machine.cpu = json.at("cpu").get<std::string>();
        machine.threads = json.at("threads").get<int>();
        machine.renderer = json.at("renderer").get<std::string>();
        machine.driver = json.at("driver").get<std::string>();
        machine.clock = json.at("clock").get<std::string>();
        machine.version = json.at("version").get<std::string>();
        machine.date = json.at("date").get<std::string>();
    });
}

} // namespace kestrel
