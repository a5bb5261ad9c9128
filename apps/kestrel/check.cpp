// `kestrel check`: is the graph right, and what would be run? No GL is needed.
#include "capabilities_file.h"
#include "commands.h"
#include "common.h"
#include "core/files.h"
#include "core/log.h"
#include "gl/context.h"
#include "measure/run_stats.h"
#include "scene/facts.h"
#include "scene/geometry.h"
#include "shader/validate.h"
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>
#include <nlohmann/json.hpp>

namespace kestrel {

namespace {

using Json = nlohmann::ordered_json;

struct CheckArguments : GraphArguments {
    std::string capabilities;
    bool gl = false, minimum = false, keepAll = false, json = false, noShaders = false;
};

// Those of the file, the minimum, or of this machine: what `render` would run here. Without OpenGL here, the
// minimum.
Capabilities capabilitiesOf(const CheckArguments& arguments) {
    if (!arguments.capabilities.empty()) return readCapabilities(arguments.capabilities);
    if (arguments.minimum) return {};
    if (arguments.gl) return gl::Context::create()->capabilities();
    try {
        return gl::Context::create()->capabilities();
    } catch (const MachineError& error) {
        logWarning("checked against the minimum of OpenGL 4.6, since there is none here: {}", error.what());
        return {};
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

std::vector<std::string> stepNames(const Plan& plan, const PlanPass& pass) {
    std::vector<std::string> names;
    for (int i = pass.firstStep; i < pass.firstStep + pass.stepCount; ++i)
        names.push_back(plan.steps.at(static_cast<size_t>(i)).step.name);
    return names;
}

void printPlan(const Plan& plan, const Capabilities& capabilities) {
    fmt::print("for: OpenGL {}, {}\n", capabilities.version,
               capabilities.renderer == "none" ? "the minimum" : capabilities.renderer);
    fmt::print("order:\n");
    for (const PlanPass& pass : plan.passes)
        fmt::print("  {} ({}): {}\n", pass.name, pass.type, fmt::join(stepNames(plan, pass), ", "));
    fmt::print("resources:\n");
    for (const PlanResource& resource : plan.resources)
        fmt::print("  {}: {}{}{}\n", resource.port.text(), describe(resource.desc),
                   resource.history ? ", with last frame's" : "", resource.transient ? "" : ", stays");
    fmt::print("memory: {}\n", memoryText(plan.memory));
    printLeftOut(plan.leftOut);
}

Json planJson(const Graph& graph, const Scene& scene, const Plan& plan, const Capabilities& capabilities) {
    Json passes = Json::array(), resources = Json::array(), leftOut = Json::array();
    for (const PlanPass& pass : plan.passes)
        passes.push_back({{"name", pass.name}, {"type", pass.type}, {"steps", stepNames(plan, pass)}});
    for (const PlanResource& resource : plan.resources)
        resources.push_back({{"port", resource.port.text()},
                             {"description", describe(resource.desc)},
                             {"bytes", resource.desc.totalBytes()},
                             {"transient", resource.transient},
                             {"history", resource.history},
                             {"object", resource.object},
                             {"offset", resource.offset},
                             {"first_step", resource.firstStep},
                             {"last_step", resource.lastStep}});
    for (const LeftOut& item : plan.leftOut) leftOut.push_back({{"what", item.what}, {"why", item.why}});
    return {{"graph", graph.name},
            {"scene", scene.name},
            {"size", {plan.size.width, plan.size.height}},
            {"renderer", capabilities.renderer},
            {"passes", passes},
            {"resources", resources},
            {"left_out", leftOut},
            {"memory",
             {{"transient", plan.memory.transient},
              {"unshared", plan.memory.unshared},
              {"persistent", plan.memory.persistent}}}};
}

int check(const CheckArguments& arguments) {
    const Registry& registry = loadedRegistry();
    const Graph graph = openGraph(arguments, registry);
    World world;
    world.size = parseSize(arguments.size);
    world.capabilities = capabilitiesOf(arguments);
    const Scene scene = openScene(arguments, graph);
    static_cast<void>(cameraIndex(scene, arguments.camera.empty() ? graph.sceneCamera : arguments.camera));
    world.facts = gatherFacts(scene);

    CompileOptions options;
    options.keepAll = arguments.keepAll;
    const Plan plan = compile(graph, registry, makePasses(graph, registry), world, options);
    if (!arguments.noShaders) requireShaders(plan, registry);
    if (arguments.json)
        fmt::print("{}\n", planJson(graph, scene, plan, world.capabilities)
                               .dump(2, ' ', false, Json::error_handler_t::replace));
    else
        printPlan(plan, world.capabilities);
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
