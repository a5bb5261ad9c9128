#include "graph/report.h"
#include "graph/barriers.h"
#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace kestrel {
namespace {

using Out = nlohmann::ordered_json;

const PlanResource& resourceAt(const Plan& plan, int index) {
    return plan.resources[static_cast<size_t>(index)];
}

std::string programName(const ProgramRequest& program) {
    return fmt::format("{}", fmt::join(program.files, "+"));
}

std::string stepText(const Plan& plan, const PlanStep& step) {
    std::string text = "    " + step.step.name;
    if (step.program >= 0)
        text += "  [" + programName(plan.programs[static_cast<size_t>(step.program)]) + "]";
    if (step.barrier != Barrier::None) text += "  after barrier " + barrierText(step.barrier);
    for (const auto& [from, to] : step.copies)
        text += fmt::format("  after copying {} to {}", resourceAt(plan, from).port.text(),
                            resourceAt(plan, to).port.text());
    return text + "\n";
}

std::string resourceUseText(const PlanResource& resource) {
    if (resource.constant) return "constant";
    if (resource.history) return "two, for the last frame's content";
    if (!resource.transient) return "persistent";
    const std::string steps = fmt::format("steps {} to {}", resource.firstStep, resource.lastStep);
    return resource.offset == 0 ? steps : fmt::format("{}, from byte {}", steps, resource.offset);
}

Out moduleJson(const ModuleInstance& instance) {
    Out json = {{"file", instance.file}, {"defines", instance.defines}};
    Out modules = Out::object();
    for (const auto& [port, inner] : instance.modules) modules[port] = moduleJson(inner);
    json["modules"] = std::move(modules);
    return json;
}

Out stepJson(const Plan& plan, const PlanStep& step) {
    Out json = {{"pass", plan.passes[static_cast<size_t>(step.pass)].name},
                {"name", step.step.name},
                {"group", step.step.group},
                {"barrier", barrierText(step.barrier)},
                {"program", step.program}};
    Out bindings = Out::array();
    for (const PlanBinding& binding : step.bindings)
        bindings.push_back({{"name", binding.name},
                            {"module", binding.path},
                            {"port", binding.port},
                            {"resource", binding.resource},
                            {"access", accessName(binding.access)},
                            {"write", binding.write},
                            {"previous", binding.previous},
                            {"linear", binding.linear},
                            {"mip", binding.mip},
                            {"layer", binding.layer}});
    json["bindings"] = std::move(bindings);
    Out copies = Out::array();
    for (const auto& [from, to] : step.copies) copies.push_back({from, to});
    json["copies"] = std::move(copies);
    return json;
}

} // namespace

std::string memoryText(const MemoryReport& memory) {
    return fmt::format("{} shared by lifetime (unshared {}), {} that stays", bytesText(memory.transient),
                       bytesText(memory.unshared), bytesText(memory.persistent));
}

std::string leftOutText(const std::vector<LeftOut>& leftOut) {
    std::string text;
    for (const LeftOut& left : leftOut)
        text += fmt::format("left out: {}, because {}\n", left.what, left.why);
    return leftOut.empty() ? "left out: nothing\n" : text;
}

std::string planText(const Plan& plan) {
    std::string text =
        fmt::format("size: {}x{}\norder: {} passes, {} steps, {} programs\n", plan.size.width,
                    plan.size.height, plan.passes.size(), plan.steps.size(), plan.programs.size());
    for (const PlanPass& pass : plan.passes) {
        text += fmt::format("  {} ({}){}\n", pass.name, pass.type,
                            pass.stepCount == 0 ? ": provides modules, runs nothing"
                            : pass.everyFrame   ? ""
                                                : ": only when something changes");
        for (int i = 0; i < pass.stepCount; ++i)
            text += stepText(plan, plan.steps[static_cast<size_t>(pass.firstStep + i)]);
    }
    text += fmt::format("resources: {} in {} objects\n", plan.resources.size(), plan.objects.size());
    for (size_t i = 0; i < plan.objects.size(); ++i) {
        const PlanObject& object = plan.objects[i];
        text +=
            fmt::format("  object {}: {}, {} bytes\n", i, describe(object.desc), object.desc.totalBytes());
        for (const PlanResource& resource : plan.resources)
            if (resource.object == static_cast<int>(i))
                text += fmt::format("    {}: {}\n", resource.port.text(), resourceUseText(resource));
    }
    return text + fmt::format("memory: {}\n", memoryText(plan.memory)) + leftOutText(plan.leftOut);
}

std::string planJson(const Plan& plan) {
    Out json;
    json["size"] = {plan.size.width, plan.size.height};
    json["passes"] = Out::array();
    for (const PlanPass& pass : plan.passes) {
        Out steps = Out::array();
        for (int i = 0; i < pass.stepCount; ++i)
            steps.push_back(plan.steps[static_cast<size_t>(pass.firstStep + i)].step.name);
        json["passes"].push_back({{"name", pass.name},
                                  {"type", pass.type},
                                  {"every_frame", pass.everyFrame},
                                  {"inputs", pass.inputs},
                                  {"ports", pass.ports},
                                  {"steps", std::move(steps)}});
    }
    json["steps"] = Out::array();
    for (const PlanStep& step : plan.steps) json["steps"].push_back(stepJson(plan, step));
    json["resources"] = Out::array();
    for (const PlanResource& resource : plan.resources)
        json["resources"].push_back({{"port", resource.port.text()},
                                     {"description", describe(resource.desc)},
                                     {"bytes", resource.desc.totalBytes()},
                                     {"transient", resource.transient},
                                     {"constant", resource.constant.has_value()},
                                     {"history", resource.history},
                                     {"object", resource.object},
                                     {"offset", resource.offset},
                                     {"first_step", resource.firstStep},
                                     {"last_step", resource.lastStep}});
    json["objects"] = Out::array();
    for (const PlanObject& object : plan.objects)
        json["objects"].push_back({{"description", describe(object.desc)},
                                   {"bytes", object.desc.totalBytes()},
                                   {"label", object.label}});
    json["programs"] = Out::array();
    for (const ProgramRequest& program : plan.programs) {
        Out modules = Out::object();
        for (const auto& [port, instance] : program.modules) modules[port] = moduleJson(instance);
        json["programs"].push_back(
            {{"files", program.files}, {"defines", program.defines}, {"modules", std::move(modules)}});
    }
    json["outputs"] = Out::array();
    for (const PlanOutput& output : plan.outputs)
        json["outputs"].push_back(
            {{"port", output.port.text()}, {"resource", output.resource}, {"preview", output.preview}});
    json["left_out"] = Out::array();
    for (const LeftOut& left : plan.leftOut)
        json["left_out"].push_back({{"what", left.what}, {"why", left.why}});
    json["memory"] = {{"transient", plan.memory.transient},
                      {"unshared", plan.memory.unshared},
                      {"persistent", plan.memory.persistent}};
    return json.dump(2, ' ', false, Out::error_handler_t::replace) + "\n";
}

} // namespace kestrel
