// Reading, comparing and joining manifests.
#include "measure/sweep_manifest.h"
#include "core/files.h"
#include "core/hash.h"
#include "graph/graph.h"
#include "image/io.h"
#include "scene/builtin.h"
#include "scene/gltf_container.h"
#include "scene/setup_keys.h"
#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace kestrel {
namespace {

using FactJson = nlohmann::json; // sorted by key: a hash does not depend on the order of growing

constexpr const char* manifestName = "sweep.manifest";
constexpr const char* manifestKey = "kestrel_sweep_manifest";

std::string contentText(const Fnv1a& hash) { return fmt::format("{:016x}", hash.value()); }

std::string contentOf(const std::filesystem::path& file) {
    Fnv1a hash;
    hash.add(readBytes(file));
    return contentText(hash);
}

// What the files that a glTF file names hold. A file that cannot be read adds nothing: importing it says why.
void addNamedFiles(const Sweep& sweep, const std::filesystem::path& path, Fnv1a& hash) {
    try {
        const GltfFile file = readGltfFile(path, {.allowOutside = sweep.allowOutside}, {});
        for (const char* list : {"buffers", "images"})
            for (const auto& item : file.document.value(list, FactJson::array())) {
                const std::string uri = item.value("uri", std::string());
                if (!uri.empty() && !uri.starts_with("data:")) hash.add(readUri(file, uri, list));
            }
    } catch (const InputError&) {
    } catch (const FactJson::exception&) {
    }
}

// Of a scene's file and those that it names. Nothing if it is not here.
std::optional<std::string> sceneContent(const Sweep& sweep, const SweepScene& scene) {
    if (scene.source.starts_with("builtin:")) return scene.source;
    const std::filesystem::path path = sweepSceneFile(sweep, scene);
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return std::nullopt;
    Fnv1a hash;
    hash.add(readBytes(path));
    addNamedFiles(sweep, path, hash);
    return contentText(hash);
}

// Files by the names that they were given, each with what it holds.
void addFile(FactJson& files, const std::string& name, const std::filesystem::path& file) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(file, ignored)) files[name] = contentOf(file);
}

// What a graph with its settings names besides itself: the path of its camera, and pictures. Which property
// is a file's name only its pass knows (beside the graph's file, the scene's, or in the working folder); a
// text that is the name of a file there is taken for one.
FactJson filesNamed(const Sweep& sweep, const std::filesystem::path& graphFile,
                    const std::vector<SweepSetting>& settings) {
    FactJson files = FactJson::object();
    std::vector<std::string> texts;
    try {
        const Graph graph = loadGraph(graphFile);
        if (graph.sceneSetup.camera && !graph.sceneSetup.camera->path.empty())
            addFile(files, graph.sceneSetup.camera->path,
                    located(graph.sceneSetup, graphFile.parent_path()).camera->path);
        for (const GraphPass& pass : graph.passes)
            for (const auto& [name, value] : pass.properties)
                if (const auto* text = std::get_if<std::string>(&value)) texts.push_back(*text);
    } catch (const InputError&) { // checkSweep() tells it
    }
    for (const SweepSetting& setting : settings)
        if (const size_t at = setting.text.find('='); at != std::string::npos)
            texts.push_back(setting.text.substr(at + 1));
    std::set<std::filesystem::path> folders{graphFile.parent_path()};
    for (const SweepScene& scene : sweep.scenes)
        folders.insert(isBuiltin(scene.source) ? "." : sweepSceneFile(sweep, scene).parent_path());
    for (const std::string& text : texts)
        for (const std::filesystem::path& folder : folders)
            if (!text.empty()) addFile(files, text, imageName(folder / text).file);
    return files;
}

FactJson settingTexts(const std::vector<SweepSetting>& settings) {
    FactJson texts = FactJson::array();
    for (const SweepSetting& setting : settings) texts.push_back(setting.text);
    return texts;
}

// What a graph with its settings is.
FactJson graphFacts(const Sweep& sweep, const std::string& graph, const std::vector<SweepSetting>& settings) {
    return {{"graph", graph},
            {"content", contentOf(sweepGraphFile(sweep, graph))},
            {"files", filesNamed(sweep, sweepGraphFile(sweep, graph), settings)},
            {"set", settingTexts(settings)}};
}

std::string shown(const FactJson& value) {
    return value.is_string() ? "'" + value.get<std::string>() + "'" : value.dump();
}

// Why what is stored under one name is not what is asked for.
void compareFacts(const std::string& kind, const FactJson& held, const FactJson& now,
                  std::vector<std::string>& causes) {
    const auto note = [&](std::string cause) {
        if (std::ranges::find(causes, cause) == causes.end()) causes.push_back(std::move(cause));
    };
    const bool named = held.contains("name") && now.contains("name");
    if (named && held["name"] != now["name"]) {
        note(fmt::format("the {} {} would lie in the files of {}, which was measured: rename it", kind,
                         shown(now["name"]), shown(held["name"])));
        return;
    }
    const std::string owner = named ? fmt::format("the {} {}", kind, shown(now["name"])) : kind;
    for (const auto& [key, value] : now.items()) {
        const auto before = held.find(key);
        if (before == held.end() || *before == value || key == "graph") continue;
        if (key == "files") {
            for (const auto& [file, content] : value.items())
                if (before->contains(file) && (*before)[file] != content)
                    note(fmt::format("the file '{}' that the graph {} names has changed", file,
                                     shown(now["graph"])));
        } else if (key == "content" && now.contains("graph"))
            note(fmt::format("the text of the graph {} has changed", shown(now["graph"])));
        else if (key == "content")
            note(fmt::format("the scene {} has changed", shown(now["name"])));
        else if (kind == "settings")
            note(fmt::format("'{}' was {} and is {}", key, shown(*before), shown(value)));
        else
            note(fmt::format("'{}' of {} was {} and is {}", key, owner, shown(*before), shown(value)));
    }
}

bool isManifest(const FactJson& json) {
    if (!json.is_object() || json.value(manifestKey, FactJson()) != 1) return false;
    if (!json.contains("machine") || !json["machine"].is_string() || !json.contains("facts")) return false;
    const auto all = [](const FactJson& values, auto&& test) {
        return values.is_object() && std::all_of(values.begin(), values.end(), test);
    };
    const auto isObject = [](const FactJson& value) { return value.is_object(); };
    return all(json["facts"], [&](const FactJson& named) { return all(named, isObject); });
}

} // namespace

SweepManifest::SweepManifest(const Sweep& sweep, std::string machine)
    : machine_(std::move(machine)) {
    facts_["settings"]["all"] = {{"size", fmt::format("{}x{}", sweep.size.width, sweep.size.height)},
                                 {"frames", sweep.frames},
                                 {"seed", sweep.seed},
                                 {"warm_up", sweep.warmUp},
                                 {"timed_frames", sweep.timedFrames},
                                 {"moving", sweep.moving},
                                 {"rebuild", sweep.rebuild},
                                 {"hdr", sweep.hdr},
                                 {"reference", sweep.reference.has_value()},
                                 {"rays", sweep.rays.has_value()}};
    if (sweep.reference) {
        const SweepReference& reference = *sweep.reference;
        FactJson facts = graphFacts(sweep, reference.graph, reference.settings);
        facts["output"] = reference.output.text();
        facts["mask"] = reference.mask ? FactJson(reference.mask->text()) : FactJson(nullptr);
        facts["frames"] = reference.frames;
        facts_["the reference"]["all"] = std::move(facts);
    }
    if (sweep.rays) {
        FactJson facts = graphFacts(sweep, sweep.rays->graph, sweep.rays->settings);
        facts["rays"] = sweep.rays->rays.text();
        facts["hits"] = sweep.rays->hits.text();
        facts["frames"] = sweep.rays->frames;
        facts_["the rays"]["all"] = std::move(facts);
    }
    for (const SweepScene& scene : sweep.scenes) {
        // Each key of the setup, also where it is not given: that it is given now is a change.
        FactJson facts = {{"name", scene.name}};
        for (const auto& key : sceneSetupKeys().keys()) facts[key.name] = key.write(scene.setup);
        facts["camera"] = scene.setup.camera ? cameraText(*scene.setup.camera) : scene.setup.cameraName;
        if (scene.setup.camera && !scene.setup.camera->path.empty())
            facts["path"] = contentOf(located(scene.setup, sweep.file.parent_path()).camera->path);
        if (const auto content = sceneContent(sweep, scene)) facts["content"] = *content;
        facts_["scene"][scene.slug] = std::move(facts);
    }
    const std::vector<SweepPoint> points = expandSweep(sweep);
    std::map<std::string, std::string> contents; // of each graph once
    for (const SweepPoint& point : points) {
        std::string& content = contents[point.graph];
        if (content.empty()) content = contentOf(sweepGraphFile(sweep, point.graph));
        FactJson facts = {{"name", point.name},
                          {"graph", point.graph},
                          {"content", content},
                          {"output", point.output.text()},
                          {"files", filesNamed(sweep, sweepGraphFile(sweep, point.graph), point.settings)},
                          {"set", settingTexts(point.settings)}};
        facts["exact"] = settingTexts(point.exact);
        // A variant's own number of frames; the sweep's and the rays' stand there.
        const bool own = !point.ray && point.frames != sweep.frames;
        facts["frames"] = own ? FactJson(point.frames) : FactJson(nullptr);
        facts_["variant"][point.slug] = std::move(facts);
    }
    if (sweep.tuned) addTuning(sweep, points);
    for (const SweepUnit& unit : sweepUnits(sweep, points)) {
        const std::string& scene = sweep.scenes[static_cast<size_t>(unit.scene)].name;
        facts_["plot"][unit.slug] = {{"name", unit.plot.empty() ? scene : scene + ": " + unit.plot}};
    }
}

// Where the search goes depends on all of this.
void SweepManifest::addTuning(const Sweep& sweep, const std::vector<SweepPoint>& points) {
    const SweepTuning& tuning = sweep.tuning.value();
    facts_["tuning"]["all"] = {{"train", tuning.train},
                               {"steps", tuning.steps},
                               {"rounds", tuning.rounds},
                               {"probes", tuning.probes},
                               {"time", tuning.mostMs ? FactJson(nullptr) : FactJson(tuning.mostTime)},
                               {"ms", tuning.mostMs ? FactJson(*tuning.mostMs) : FactJson(nullptr)},
                               {"plot.time", sweep.plotTime},
                               {"plot.error", sweep.plotError}};
    for (const SweepPoint& point : points) {
        if (point.free.empty()) continue;
        FactJson free = FactJson::object();
        for (const SweepFree& property : point.free)
            free[property.name] = property.choices.empty()
                                      ? FactJson{property.low, property.high, property.logarithmic}
                                      : settingTexts(property.choices);
        facts_["free properties"][point.slug] = {{"name", point.name}, {"tune", std::move(free)}};
    }
}

std::optional<SweepManifest> SweepManifest::read(const std::filesystem::path& folder) {
    const std::filesystem::path file = folder / manifestName;
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return std::nullopt;
    const FactJson json = FactJson::parse(readText(file), nullptr, false);
    if (!isManifest(json))
        throw InputError(
            Location{file.string()},
            "is of another version of Kestrel, or damaged: what was measured here cannot be kept; "
            "measure into another folder, or remove this one");
    SweepManifest manifest;
    manifest.machine_ = json["machine"].get<std::string>();
    manifest.facts_ = json["facts"];
    return manifest;
}

void SweepManifest::write(const std::filesystem::path& folder) const {
    const FactJson json = {{manifestKey, 1}, {"machine", machine_}, {"facts", facts_}};
    writeFile(folder / manifestName, json.dump(1, ' ', false, FactJson::error_handler_t::replace) + "\n");
}

std::vector<std::string> SweepManifest::changes(const SweepManifest& now) const {
    std::vector<std::string> causes;
    for (const auto& [kind, named] : now.facts_.items()) {
        const auto held = facts_.find(kind);
        if (held == facts_.end()) continue;
        for (const auto& [name, facts] : named.items())
            if (const auto before = held->find(name); before != held->end())
                compareFacts(kind, *before, facts, causes);
    }
    return causes;
}

void SweepManifest::add(const SweepManifest& other) {
    for (const auto& [kind, named] : other.facts_.items())
        for (const auto& [name, facts] : named.items()) {
            FactJson& mine = facts_[kind][name];
            for (const auto& [key, value] : facts.items())
                if (!mine.contains(key)) mine[key] = value;
        }
}

std::string SweepManifest::hash() const {
    Fnv1a hash;
    hash.add(facts_.dump(-1, ' ', false, FactJson::error_handler_t::replace));
    return contentText(hash);
}

} // namespace kestrel
