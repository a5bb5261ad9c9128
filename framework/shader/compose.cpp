#include "shader/compose.h"
#include "core/hash.h"
#include "shader/names.h"
#include "shader/stage_composer.h"
#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace kestrel {
namespace {

struct StageFile {
    ShaderStage stage;
    std::string file;
};

// The files in the order of the pipeline.
std::vector<StageFile> stageFiles(const std::vector<std::string>& files, std::vector<Problem>& problems) {
    std::vector<StageFile> stages;
    for (const std::string& file : files) {
        if (const std::optional<ShaderStage> stage = shaderStageOf(file)) {
            stages.push_back({*stage, file});
        } else {
            problems.push_back({{file}, "is no stage: the file must end in .vert, .geom, .frag or .comp"});
        }
    }
    std::stable_sort(stages.begin(), stages.end(),
                     [](const auto& a, const auto& b) { return a.stage < b.stage; });
    return stages;
}

void checkStages(const std::vector<StageFile>& stages, std::vector<Problem>& problems) {
    if (stages.empty()) {
        problems.push_back({{}, "a program needs at least one stage file"});
        return;
    }
    for (size_t i = 1; i < stages.size(); ++i) {
        if (stages[i].stage == stages[i - 1].stage)
            problems.push_back({{stages[i].file},
                                fmt::format("is a second {} stage beside {}",
                                            shaderStageName(stages[i].stage), stages[i - 1].file)});
    }
    const bool computes = stages.back().stage == ShaderStage::Compute;
    if (computes && stages.front().stage != ShaderStage::Compute)
        problems.push_back({{stages.back().file}, "a compute stage stands alone in its program"});
    if (!computes && stages.front().stage != ShaderStage::Vertex)
        problems.push_back({{stages.front().file}, "the program has no vertex stage"});
}

void checkDefines(const Defines& defines, const std::string& program, std::vector<Problem>& problems) {
    for (const auto& [name, text] : defines) {
        std::string why = whyNotAName(name);
        if (why.empty() && text.find('\n') != std::string::npos) why = "has a text of more than one line";
        if (!why.empty()) problems.push_back({{program}, fmt::format("the define '{}' {}", name, why)});
    }
}

// FNV-1a, then the finalizer of SplitMix64: FNV's low bits mix poorly.
class TextHash {
public:
    void add(std::string_view text) {
        const std::uint64_t size = text.size();
        hash_.add(text);
        hash_.add(std::as_bytes(std::span(&size, 1)));
    }
    [[nodiscard]] std::uint64_t value() const {
        std::uint64_t h = hash_.value();
        h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
        h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
        return h ^ (h >> 31);
    }

private:
    Fnv1a hash_;
};

std::string joined(const std::vector<StageFile>& stages) {
    std::string name;
    for (const StageFile& stage : stages) name += (name.empty() ? "" : "+") + stage.file;
    return name;
}

} // namespace

ComposedProgram compose(const ProgramRequest& request, ShaderLibrary& library) {
    std::vector<Problem> problems;
    const std::vector<StageFile> stages = stageFiles(request.files, problems);
    checkStages(stages, problems);
    ComposedProgram program;
    program.name = joined(stages);
    checkDefines(request.defines, program.name, problems);
    if (!problems.empty()) throw InputError(std::move(problems));

    std::set<std::string> dependencies;
    TextHash hash;
    for (const StageFile& stage : stages) {
        program.stages.push_back(
            StageComposer(request, library, problems, dependencies).compose(stage.file, stage.stage));
        hash.add(shaderStageName(stage.stage));
        hash.add(program.stages.back().text);
    }
    if (!problems.empty()) throw InputError(std::move(problems));
    program.dependencies.assign(dependencies.begin(), dependencies.end());
    program.key = hash.value();
    return program;
}

std::vector<Defines> allCombinations(const std::map<std::string, std::vector<std::string>>& choices) {
    std::vector<Defines> combinations{{}};
    for (const auto& [name, values] : choices) {
        if (values.empty())
            throw InputError(fmt::format("the define '{}' has no value to choose from", name));
        std::vector<Defines> longer;
        for (const Defines& shorter : combinations) {
            for (const std::string& value : values) {
                longer.push_back(shorter);
                if (value != undefinedChoice) longer.back()[name] = value;
            }
        }
        combinations = std::move(longer);
    }
    return combinations;
}

} // namespace kestrel
