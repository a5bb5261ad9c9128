// Compiler stage: gives out resources, and writes down what each step binds.
#include "graph/network.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel::compiler {
namespace {

// All of a request as one text, to find equal ones.
void appendKey(const Defines& defines, const std::map<std::string, ModuleInstance>& modules,
               std::string& key) {
    for (const auto& [name, text] : defines) key += fmt::format("{}={}\n", name, text);
    for (const auto& [port, instance] : modules) {
        key += fmt::format("<{}:{}\n", port, instance.file);
        appendKey(instance.defines, instance.modules, key);
        key += ">\n";
    }
}

class Builder {
public:
    Builder(const Network& network, const Order& order)
        : network_(network)
        , order_(order) {}

    Plan run() {
        plan_.size = network_.world.size;
        bindAll();
        makePlanPasses();
        makeResources();
        for (const int node : order_.nodes)
            if (passOf_.contains(node)) fillPass(node);
        noteOutputs();
        findLifetimes();
        return std::move(plan_);
    }

private:
    // Where the content of a source lies: in-place updates share the resource of what they update.
    [[nodiscard]] Source physical(Source source) const {
        for (auto alias = order_.inPlace.find(source); alias != order_.inPlace.end();
             alias = order_.inPlace.find(source))
            source = alias->second;
        return source;
    }
    [[nodiscard]] int resourceOf(const Source& source) const {
        const auto found = resources_.find(physical(source));
        return found == resources_.end() ? -1 : found->second;
    }

    void bindAll() {
        for (const int node : order_.nodes)
            for (const Step& step : network_.at(node).real.steps) {
                auto& bound = bound_[node].emplace_back(boundUses(network_, node, step));
                for (const BoundUse& use : bound) {
                    const Source source = physical(use.source);
                    used_.insert(source);
                    if (use.use.previous) history_.insert(source);
                    if (!network_.at(node).everyFrame()) sometimes_.insert(source);
                }
            }
        for (const Source& source : network_.wanted) {
            const Source seen = origin(network_, source);
            if (findOutput(network_.at(seen.node).real, seen.port) == nullptr) continue;
            used_.insert(physical(seen));
            wanted_.insert(physical(seen));
        }
        for (const int node : order_.nodes)
            for (const Output& output : network_.at(node).real.outputs)
                if (const auto old = copiedFrom(node, output)) {
                    used_.insert(physical(*old));
                    if (!network_.at(node).everyFrame()) sometimes_.insert(physical(*old));
                }
    }

    // What an output that cannot be updated in place is copied from.
    [[nodiscard]] std::optional<Source> copiedFrom(int node, const Output& output) const {
        if (output.updates.empty() || order_.inPlace.contains({node, output.port})) return {};
        if (!used_.contains({node, output.port})) return {};
        return originOfInput(network_, node, output.updates);
    }

    // Passes without steps stay if they provide modules: their causes pass on to the consumers.
    void makePlanPasses() {
        for (const int node : order_.nodes) {
            const Node& from = network_.at(node);
            if (from.real.steps.empty() && from.real.modules.empty()) continue;
            passOf_[node] = static_cast<int>(plan_.passes.size());
            PlanPass pass;
            pass.name = from.name();
            pass.type = from.type->name;
            pass.instance = from.instance;
            pass.depends = from.real.depends;
            pass.always = from.real.always;
            pass.everyFrame = from.everyFrame();
            plan_.passes.push_back(std::move(pass));
        }
    }

    void makeResources() {
        for (const int node : order_.nodes)
            for (const Output& output : network_.at(node).real.outputs) {
                const Source source{node, output.port};
                if (!used_.contains(source) || physical(source) != source || !output.same.empty()) continue;
                PlanResource resource;
                resource.port = {network_.at(node).name(), output.port};
                resource.desc = output.desc;
                resource.clear = output.clear;
                resource.constant = output.constant;
                resource.history = history_.contains(source);
                resource.transient = network_.at(node).everyFrame() && !resource.history && !output.keeps &&
                                     !resource.constant && !wanted_.contains(source) &&
                                     !sometimes_.contains(source) && !isCounter(node, output.port);
                resources_[source] = static_cast<int>(plan_.resources.size());
                plan_.resources.push_back(std::move(resource));
            }
    }

    // Read at the end of the frame.
    [[nodiscard]] bool isCounter(int node, const std::string& port) const {
        const std::vector<Output>& outputs = network_.at(node).real.outputs;
        return std::any_of(outputs.begin(), outputs.end(),
                           [&](const Output& output) { return output.counter == port; });
    }

    void fillPass(int node) {
        const Node& from = network_.at(node);
        PlanPass& pass = plan_.passes[static_cast<size_t>(passOf_.at(node))];
        pass.firstStep = static_cast<int>(plan_.steps.size());
        for (size_t i = 0; i < from.real.steps.size(); ++i)
            addStep(node, from.real.steps[i], bound_[node][i]);
        pass.stepCount = static_cast<int>(plan_.steps.size()) - pass.firstStep;
        pass.repeatable = !from.real.always;
        for (const Output& output : from.real.outputs) {
            if (output.keeps || !output.updates.empty()) pass.repeatable = false;
            if (output.counter.empty()) continue;
            const int counter = resourceOf({node, output.counter});
            if (counter >= 0) pass.counters.push_back({output.port, counter, output.capacity});
        }
        if (pass.stepCount > 0)
            for (const Output& output : from.real.outputs)
                if (const auto old = copiedFrom(node, output))
                    plan_.steps[static_cast<size_t>(pass.firstStep)].copies.emplace_back(
                        resourceOf(*old), resourceOf({node, output.port}));
        notePorts(node, pass);
        noteInputs(node, pass);
    }

    void addStep(int node, const Step& step, const std::vector<BoundUse>& bound) {
        PlanStep planned;
        planned.pass = passOf_.at(node);
        planned.step = step;
        for (const BoundView& view : viewsOf(network_, node, step))
            planned.views.push_back({view.name, view.view, view.extent,
                                     view.source ? resourceOf(*view.source) : -1, view.previous});
        for (const BoundUse& use : bound) {
            PlanBinding binding;
            binding.name = use.name;
            binding.path = use.path;
            binding.port = use.use.port;
            binding.resource = resourceOf(use.source);
            binding.access = use.use.access;
            binding.write = use.use.write;
            binding.previous = use.use.previous;
            binding.linear = use.use.linear;
            binding.mip = use.use.mip;
            binding.layer = use.use.layer;
            planned.bindings.push_back(std::move(binding));
        }
        if (!step.shaders.empty()) planned.program = programIndex(programOf(network_, node, step));
        plan_.steps.push_back(std::move(planned));
    }

    int programIndex(ProgramRequest request) {
        std::string key = fmt::format("{}\n", fmt::join(request.files, "+"));
        appendKey(request.defines, request.modules, key);
        const auto [found, fresh] = programs_.try_emplace(key, static_cast<int>(plan_.programs.size()));
        if (fresh) plan_.programs.push_back(std::move(request));
        return found->second;
    }

    void notePorts(int node, PlanPass& pass) const {
        const Node& from = network_.at(node);
        for (const PortInfo& port : from.type->ports) {
            const Desc* desc = nullptr;
            std::optional<Source> source;
            if (port.direction == PortDirection::Input) {
                if (from.inputs.connected(port.name)) desc = &from.inputs[port.name].desc;
                source = originOfInput(network_, node, port.name);
            } else if (const Output* output = findOutput(from.real, port.name)) {
                desc = &output->desc;
                source = origin(network_, {node, port.name});
            }
            if (desc == nullptr) continue;
            pass.descs[port.name] = *desc;
            const int resource = source ? resourceOf(*source) : -1;
            if (resource >= 0) pass.ports[port.name] = resource;
        }
    }

    void noteInputs(int node, PlanPass& pass) const {
        const Node& from = network_.at(node);
        const auto planned = [&](const std::string& input) {
            std::vector<int> passes;
            for (const int producer : producersBehind(network_, node, input))
                if (const auto found = passOf_.find(producer); found != passOf_.end())
                    passes.push_back(found->second);
            std::sort(passes.begin(), passes.end());
            return passes;
        };
        for (const auto& [input, source] : from.feeds) pass.inputPasses[input] = planned(input);
        std::set<int> behind;
        const auto inherit = [&](const std::string& input) {
            const std::vector<int> passes = planned(input);
            behind.insert(passes.begin(), passes.end());
        };
        for (const Step& step : from.real.steps) {
            for (const Use& use : step.uses)
                if (isInput(from, use.port)) inherit(use.port);
            for (const ModuleUse& use : step.modules) inherit(use.port);
        }
        for (const Output& output : from.real.outputs)
            if (!output.updates.empty()) inherit(output.updates);
        pass.inputs.assign(behind.begin(), behind.end());
    }

    void noteOutputs() {
        const auto& asked = network_.graph.outputs;
        for (size_t i = 0; i < network_.wanted.size(); ++i) {
            const bool preview = i >= asked.size();
            PlanOutput output;
            output.port = preview ? network_.options.previews[i - asked.size()] : asked[i].port;
            output.resource = resourceOf(origin(network_, network_.wanted[i]));
            output.preview = preview;
            plan_.outputs.push_back(std::move(output));
        }
    }

    // First and last step that touch a resource. What outlives a frame, lives for the whole of it.
    void findLifetimes() {
        const int last = std::max(static_cast<int>(plan_.steps.size()) - 1, 0);
        for (PlanResource& resource : plan_.resources) {
            resource.firstStep = resource.transient ? last : 0;
            resource.lastStep = resource.transient ? 0 : last;
        }
        const auto touch = [&](int index, int step) {
            PlanResource& resource = plan_.resources[static_cast<size_t>(index)];
            resource.firstStep = std::min(resource.firstStep, step);
            resource.lastStep = std::max(resource.lastStep, step);
        };
        for (size_t i = 0; i < plan_.steps.size(); ++i) {
            for (const PlanBinding& binding : plan_.steps[i].bindings)
                touch(binding.resource, static_cast<int>(i));
            for (const auto& [from, to] : plan_.steps[i].copies) {
                touch(from, static_cast<int>(i));
                touch(to, static_cast<int>(i));
            }
        }
        for (const PlanPass& pass : plan_.passes) // clears come before the first step
            for (const auto& [port, resource] : pass.ports) {
                const PlanResource& made = plan_.resources[static_cast<size_t>(resource)];
                if (made.clear && made.port.pass == pass.name) touch(resource, pass.firstStep);
            }
    }

    const Network& network_;
    const Order& order_;
    Plan plan_;
    std::map<int, std::vector<std::vector<BoundUse>>> bound_; // node -> step -> uses
    std::set<Source> used_, history_, wanted_, sometimes_;    // sometimes_: a user may be skipped
    std::map<Source, int> resources_;
    std::map<int, int> passOf_; // node -> index into plan_.passes
    std::map<std::string, int> programs_;
};

} // namespace

Plan allocateResources(const Network& network, const Order& order) { return Builder(network, order).run(); }

} // namespace kestrel::compiler
