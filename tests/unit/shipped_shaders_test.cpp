// Every program that a shipped pass can choose compiles: every combination of its choices and flags, over
// scenes that differ in what materials need. By glslang, so no context is asked for.
#include "core/files.h"
#include "draw/material_defines.h"
#include "graph/plan.h"
#include "plugin/loader.h"
#include "shader/validate.h"
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unordered_set>

namespace kestrel {
namespace {

const Registry& shipped() {
    static const Registry instance = [] {
        Registry registry;
        loadPlugins(registry, pluginFolders());
        return registry;
    }();
    return instance;
}

// One setting per value of a property; numbers at their ends, where the ends are programs of their own.
std::vector<std::string> settingsOf(const GraphPass& pass, const PropertyInfo& property) {
    const std::string name = pass.name + "." + property.name + "=";
    std::vector<std::string> settings;
    if (property.kind == PropertyKind::Choice)
        for (const std::string& choice : property.choices) settings.push_back(name + choice);
    if (property.kind == PropertyKind::Bool) settings = {name + "true", name + "false"};
    return settings;
}

// Of a table with more combinations than this every two settings are seen together, not all of them.
constexpr size_t mostCombinations = 100;

// All combinations of the settings of one pass.
std::vector<std::vector<std::string>> combinations(const GraphPass& pass) {
    std::vector<std::vector<std::string>> all = {{}};
    for (const PropertyInfo& property : shipped().find(pass.type)->properties) {
        const auto settings = settingsOf(pass, property);
        if (settings.empty()) continue;
        std::vector<std::vector<std::string>> more;
        for (const auto& before : all)
            for (const std::string& setting : settings) {
                more.push_back(before);
                more.back().push_back(setting);
            }
        all = std::move(more);
    }
    if (all.size() <= mostCombinations) return all;
    std::vector<std::vector<std::string>> pairs;
    const auto& properties = shipped().find(pass.type)->properties;
    for (size_t i = 0; i < properties.size(); ++i)
        for (size_t k = i + 1; k < properties.size(); ++k)
            for (const std::string& one : settingsOf(pass, properties[i]))
                for (const std::string& other : settingsOf(pass, properties[k]))
                    pairs.push_back({one, other});
    return pairs;
}

// Little of what shaders have parts for.
SceneFacts plainWorld() {
    SceneFacts plain;
    plain.triangles = 100;
    plain.vertices = 300;
    plain.materials = 1;
    plain.bounds.add(glm::vec3(-1));
    plain.bounds.add(glm::vec3(1));
    plain.sphere = {glm::vec3(0), 1.8f};
    plain.spotLights = 1;
    return plain;
}

// All that a scene can have.
SceneFacts richWorld() {
    SceneFacts rich = plainWorld();
    rich.hasMasked = rich.hasBlend = rich.hasDoubleSided = rich.hasSingleSided = true;
    rich.hasTextures = rich.hasNormalMaps = rich.hasVertexColours = true;
    rich.hasEmission = rich.hasTransmission = rich.hasUnlit = true;
    rich.geometryMoves = rich.geometryDeforms = rich.cameraMoves = rich.lightsMove = true;
    rich.maskedTriangles = 10;
    rich.images = 3;
    rich.colourTextureArrays = 2;
    rich.dataTextureArrays = 1;
    rich.pointLights = 3;
    rich.spotLights = rich.directionalLights = rich.rectangleLights = rich.sphereLights = 1;
    return rich;
}

// Facts that differ in what shaders contain.
std::vector<SceneFacts> worlds() { return {plainWorld(), richWorld(), SceneFacts{}}; }

// What a program is composed of: equal for equal programs, and made in far less time than the program is.
void appendWord(const std::string& word, std::string& key) { key.append(word).push_back('\0'); }
void appendParts(const Defines& defines, const std::map<std::string, ModuleInstance>& modules,
                 std::string& key) {
    for (const auto& [name, text] : defines) {
        appendWord(name, key);
        appendWord(text, key);
    }
    for (const auto& [port, module] : modules) {
        key += "{";
        appendWord(port, key);
        appendWord(module.file, key);
        appendParts(module.defines, module.modules, key);
        key += "}";
    }
}
std::string partsOf(const ProgramRequest& request) {
    std::string key;
    for (const std::string& file : request.files) appendWord(file, key);
    appendParts(request.defines, request.modules, key);
    return key;
}

class Programs {
public:
    Programs()
        : library_(folders()) {}
    // Validates the programs of a plan that were not seen before. Most plans differ in few programs, and what
    // is asked for in other words may be the same text.
    void validatePlan(const Plan& plan, const std::string& what) {
        for (const ProgramRequest& request : plan.programs) {
            if (!requests_.insert(partsOf(request)).second) continue;
            const ComposedProgram program = compose(request, library_);
            if (!seen_.insert(program.key).second) continue;
            for (const Problem& problem : validate(program)) ADD_FAILURE() << what << "\n" << problem.text();
        }
    }
    [[nodiscard]] size_t count() const { return seen_.size(); }

private:
    static std::vector<std::filesystem::path> folders() {
        std::vector<std::filesystem::path> all = {shareFolder() / "shaders"};
        all.insert(all.end(), shipped().shaderFolders.begin(), shipped().shaderFolders.end());
        return all;
    }
    ShaderLibrary library_;
    std::unordered_set<std::string> requests_;
    std::unordered_set<std::uint64_t> seen_;
};

World worldOf(const SceneFacts& facts) {
    World world;
    world.facts = facts;
    world.capabilities.extensions = {"GL_ARB_fragment_shader_interlock", "GL_EXT_shader_framebuffer_fetch",
                                     "GL_ARB_shader_viewport_layer_array"};
    world.capabilities.maxTextureBufferTexels = std::int64_t{1} << 27;
    return world;
}

Plan planOf(const Graph& graph, const SceneFacts& facts, bool keepAll) {
    return compile(graph, shipped(), makePasses(graph, shipped()), worldOf(facts),
                   {.keepAll = keepAll, .shareMemory = false, .previews = {}});
}

TEST(ShippedShaders, CompileUnderEveryCombinationOfDefines) {
    Programs programs;
    for (const auto& entry : std::filesystem::directory_iterator(shareFolder() / "graphs")) {
        if (entry.path().extension() != ".json" || entry.path().stem() == "schema") continue;
        const Graph graph = loadGraph(entry.path());
        if (!validate(graph, shipped()).empty()) continue; // a part that is not built in
        const std::string name = entry.path().stem().string();
        for (const SceneFacts& facts : worlds()) programs.validatePlan(planOf(graph, facts, true), name);
        for (const GraphPass& pass : graph.passes)
            for (const auto& settings : combinations(pass)) {
                Graph changed = graph;
                for (const std::string& setting : settings) applySetting(changed, shipped(), setting);
                const std::string what = fmt::format("{} {}", name, fmt::join(settings, " "));
                for (const SceneFacts& facts : worlds())
                    programs.validatePlan(planOf(changed, facts, false), what);
                // What is kept for any scene depends on a scene's counts alone.
                programs.validatePlan(planOf(changed, richWorld(), true), what);
            }
    }
    RecordProperty("programs", static_cast<int>(programs.count()));
    EXPECT_GT(programs.count(), 40u);
}

TEST(ShippedGraphs, AreValidAndCanonical) {
    for (const auto& entry : std::filesystem::directory_iterator(shareFolder() / "graphs")) {
        if (entry.path().extension() != ".json" || entry.path().stem() == "schema") continue;
        const Graph graph = loadGraph(entry.path());
        EXPECT_EQ(saveGraph(graph), readText(entry.path())) << entry.path();
        if (shipped().find("ReferenceAmbientOcclusion") == nullptr) continue;
        for (const Problem& problem : validate(graph, shipped())) ADD_FAILURE() << problem.text();
    }
}

} // namespace
} // namespace kestrel
