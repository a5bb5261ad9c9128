// The commands that make a result again, as they can be run from any folder.
#include "core/files.h"
#include "measure/sweep_results.h"
#include <fmt/format.h>

namespace kestrel {
namespace {

namespace fs = std::filesystem;

std::string joined(const std::vector<std::string>& words) {
    std::string command;
    for (const std::string& word : words) command += (command.empty() ? "" : " ") + shellWord(word);
    return command;
}

// Without a folder of the reader's in it: links and ".." are followed where the file is there.
std::string fromAnywhere(const fs::path& file) {
    std::error_code failure;
    const fs::path real = fs::canonical(file, failure);
    return failure ? fs::absolute(file).string() : real.string();
}

} // namespace

std::string shellWord(const std::string& word) {
    const bool plain =
        !word.empty() && word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                                "0123456789_-+=./:,@%") == std::string::npos;
    if (plain) return word;
    std::string quoted;
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return "'" + quoted + "'";
}

std::string renderCommand(const Sweep& sweep, const SweepScene& scene, const SweepPoint& point) {
    std::vector<std::string> words{"kestrel", "render", fromAnywhere(sweepGraphFile(sweep, point.graph)),
                                   "--scene"};
    const bool builtin = scene.source.starts_with("builtin:");
    words.push_back(builtin ? scene.source : fromAnywhere(sweepSceneFile(sweep, scene)));
    const SceneSetup setup = located(scene.setup, sweep.file.parent_path());
    if (!setup.cameraName.empty()) words.insert(words.end(), {"--camera", setup.cameraName});
    if (setup.camera) words.insert(words.end(), {"--camera", cameraText(*setup.camera)});
    for (const AddedLight& light : setup.lights) words.insert(words.end(), {"--light", lightText(light)});
    if (!setup.animation.empty()) words.insert(words.end(), {"--animation", setup.animation});
    if (setup.time) words.insert(words.end(), {"--time", fmt::format("{}", *setup.time)});
    if (setup.fps) words.insert(words.end(), {"--fps", fmt::format("{}", *setup.fps)});
    if (sweep.allowOutside) words.push_back("--allow-outside");
    words.insert(words.end(), {"--size", fmt::format("{}x{}", sweep.size.width, sweep.size.height),
                               "--frames", std::to_string(point.frames)});
    if (sweep.seed != 0) words.insert(words.end(), {"--seed", std::to_string(sweep.seed)});
    if (!sweep.moving) words.push_back("--still");
    for (const SweepSetting& setting : point.settings) words.insert(words.end(), {"--set", setting.text});
    words.insert(words.end(), {"--output", fmt::format("{}={}.{}", point.output.text(), point.slug,
                                                       point.ray ? "bin" : "exr")});
    return joined(words);
}

std::string timesCommand(const Sweep& sweep, const SweepPoint& point) {
    std::vector<std::string> words{"kestrel",
                                   sweep.tuned ? "tune" : "sweep",
                                   fromAnywhere(sweep.file),
                                   "--size",
                                   fmt::format("{}x{}", sweep.size.width, sweep.size.height),
                                   "--frames",
                                   std::to_string(sweep.frames),
                                   "--only",
                                   point.tunedOf.empty() ? point.name : point.tunedOf};
    if (sweep.allowOutside) words.push_back("--allow-outside");
    words.insert(words.end(), {"--out", "again"});
    return joined(words);
}

std::string sweepCommand(const Sweep& sweep) {
    std::error_code failure;
    const fs::path shipped = fs::canonical(shareFolder() / "graphs", failure);
    const fs::path file = fs::weakly_canonical(sweep.file, failure);
    const fs::path within = file.lexically_relative(shipped);
    const bool ours = !within.empty() && *within.begin() != "..";
    std::vector<std::string> words{"kestrel", sweep.tuned ? "tune" : "sweep",
                                   ours ? ("graphs" / within).generic_string() : sweep.file.string()};
    if (sweep.sizeGiven)
        words.insert(words.end(), {"--size", fmt::format("{}x{}", sweep.size.width, sweep.size.height)});
    if (sweep.framesGiven) words.insert(words.end(), {"--frames", std::to_string(sweep.frames)});
    if (sweep.allowOutside) words.push_back("--allow-outside");
    words.insert(words.end(), {"--out", "results"});
    return joined(words);
}

} // namespace kestrel
