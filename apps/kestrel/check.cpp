// `kestrel check`: is the graph right, and what would be run? No GL is needed.
#include "capabilities_file.h"
#include "commands.h"
#include "common.h"
#include "core/files.h"
#include "core/log.h"
#include "gl/context.h"
#include "graph/report.h"
#include "scene/facts.h"
#include "scene/geometry.h"
#include "shader/validate.h"
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

namespace kestrel {

namespace {

using OrderedJson = nlohmann::ordered_json;

struct CheckArguments : GraphArguments {
    std::string capabilities;
    bool gl = false, minimum = false, keepAll = false, json = false, noShaders = false;
};

// What a graph is checked against. `chosen`: a device stands behind it, or the user named it; if not, a limit
// is no mistake of the graph.
struct Device {
    Capabilities capabilities;
    bool chosen = true;
};

// Those of the file, the minimum, or of this machine: what `render` would run here. Without OpenGL here, the
// minimum.
Device deviceOf(const CheckArguments& arguments) {
    if (!arguments.capabilities.empty()) return {readCapabilities(arguments.capabilities)};
    if (arguments.minimum) return {};
    if (arguments.gl) return {gl::Context::create()->capabilities()};
    try {
        return {gl::Context::create()->capabilities()};
    } catch (const MachineError& error) {
        logWarning("checked against the minimum of OpenGL 4.6, since there is none here: {}", error.what());
        return {.capabilities = {}, .chosen = false};
    }
}

// Every program of the plan, composed and parsed as a driver would.
void requireShaders(const Plan& plan, const Registry& registry) {
    std::vector<std::filesystem::path> folders{shareFolder() / "shaders"};
    folders.insert(folders.end(), registry.shaderFolders.begin(), registry.shaderFolders.end());
    ShaderLibrary library(folders);
    std::vector<Problem> problems;
    const auto add = [&](const std::vector<Problem>& more) {
        problems.insert(problems.end(), more.begin(), more.end());
    };
    for (const ProgramRequest& request : plan.programs) try {
            add(validate(compose(request, library)));
        } catch (const InputError& error) {
            add(error.problems());
        }
    if (!problems.empty()) throw InputError(std::move(problems));
}

OrderedJson checkJson(const Graph& graph, const Scene& scene, const Plan& plan,
                      const Capabilities& capabilities) {
    OrderedJson json = {{"graph", graph.name}, {"scene", scene.name}, {"renderer", capabilities.renderer}};
    json.update(OrderedJson::parse(planJson(plan)));
    return json;
}

// Against the device; where none is there, what only limits object to is a note.
Plan planFor(const Graph& graph, const Registry& registry, World world, const CompileOptions& options,
             bool chosen) {
    const PassSet passes = makePasses(graph, registry);
    try {
        return compile(graph, registry, passes, world, options);
    } catch (const Error& error) {
        if (chosen) throw;
        world.capabilities = Capabilities::unlimited();
        Plan plan = compile(graph, registry, passes, world, options); // throws if there is more than limits
        for (const Problem& problem : error.problems())
            logWarning("beyond the minimum of OpenGL 4.6: {}", problem.message);
        return plan;
    }
}

int check(const CheckArguments& arguments) {
    const Registry& registry = loadedRegistry();
    const Graph graph = openGraph(arguments, registry);
    if (graph.outputs.empty())
        throw InputError(Location{arguments.graph}, "the graph has no outputs: nothing of it would be made");
    World world;
    world.size = parseSize(arguments.size);
    const Device device = deviceOf(arguments);
    world.capabilities = device.capabilities;
    const Scene scene = openScene(arguments, graph);
    world.facts = gatherFacts(scene);

    CompileOptions options;
    options.keepAll = arguments.keepAll;
    const Plan plan = planFor(graph, registry, world, options, device.chosen);
    if (!arguments.noShaders) requireShaders(plan, registry);
    if (arguments.json)
        fmt::print("{}\n", checkJson(graph, scene, plan, world.capabilities)
                               .dump(2, ' ', false, OrderedJson::error_handler_t::replace));
    else
        say("for: OpenGL {}, {}\n{}", world.capabilities.version,
            world.capabilities.renderer == "none" ? "the minimum" : world.capabilities.renderer,
            planText(plan));
    return static_cast<int>(ExitStatus::Done);
}

} // namespace

void addCheckCommand(CLI::App& app, Run& run) {
    CLI::App* command = app.add_subcommand(
        "check",
        "Validate a graph and its shaders; tell the order, what is left out and why, and the memory");
    const auto arguments = std::make_shared<CheckArguments>();
    addGraphArguments(*command, *arguments);
    CLI::Option* file = command->add_option("--capabilities", arguments->capabilities,
                                            "What the machine can do, as JSON; default: what this one can");
    CLI::Option* minimum = command->add_flag(
        "--minimum", arguments->minimum, "Take the least that OpenGL 4.6 guarantees; needs no OpenGL here");
    command->add_flag("--gl", arguments->gl, "Fail (exit 3) if this machine has no OpenGL 4.6")
        ->excludes(file)
        ->excludes(minimum);
    minimum->excludes(file);
    command->add_flag("--keep-all", arguments->keepAll, "Leave nothing out");
    command->add_flag("--no-shaders", arguments->noShaders, "Do not look at the shaders");
    command->add_flag("--json", arguments->json, "Print JSON");
    command->footer("Examples:\n"
                    "  kestrel check graphs/ray_ao.json --scene builtin:blob\n"
                    "  kestrel check graphs/ray_ao.json --set ao.tracer=bvh.tracer --json");
    command->callback([arguments, &run] { run = [arguments] { return check(*arguments); }; });
}

} // namespace kestrel
