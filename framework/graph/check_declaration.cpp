// What is wrong with a declaration: against the pass's own tables, what is connected, and the device's
// limits.
#include "graph/network.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel::compiler {
namespace {

class Checker {
public:
    Checker(const Network& network, int node, const Declaration& declaration, const Demand& demand)
        : network_(network)
        , index_(node)
        , node_(network.at(node))
        , declaration_(declaration)
        , demand_(demand) {}

    std::vector<DeclarationProblem> run() {
        for (const PortInfo& port : node_.type->ports)
            if (port.direction == PortDirection::Input && node_.inputs.connected(port.name)) checkInput(port);
        std::set<std::string> ports;
        for (const Output& output : declaration_.outputs) {
            if (!ports.insert(output.port).second) note(output.port, "is declared twice");
            checkOutput(output);
        }
        std::set<std::string> modules;
        for (const Module& module : declaration_.modules) {
            if (!modules.insert(module.port).second) note(module.port, "the module is declared twice");
            checkModule(module);
        }
        std::set<std::string> steps;
        for (const Step& step : declaration_.steps) {
            if (step.name.empty()) note("", "a step has no name");
            if (!steps.insert(step.name).second)
                note("", fmt::format("the step '{}' is declared twice", step.name));
            checkStep(step);
        }
        for (const Output& output : declaration_.outputs) {
            checkWritten(output);
            if (output.clear && declaration_.steps.empty())
                note(output.port, "has a clear value, but there is no step that it is set before");
        }
        return std::move(problems_);
    }

private:
    void note(const std::string& port, std::string message) {
        problems_.push_back({port, std::move(message)});
    }
    void noteLimit(const std::string& port, std::string message) {
        problems_.push_back({port, std::move(message), true});
    }

    // The port's entry in the pass type's table; an unknown one is noted.
    const PortInfo* known(const std::string& port, const std::string& what) {
        const PortInfo* info = node_.type->port(port);
        if (info != nullptr) return info;
        std::vector<std::string> names;
        for (const PortInfo& candidate : node_.type->ports) names.push_back(candidate.name);
        note("", fmt::format("{} '{}', a port that the type does not have{}", what, port,
                             didYouMean(port, names)));
        return nullptr;
    }

    // What is connected, against what the table of the pass type says of the port.
    void checkInput(const PortInfo& port) {
        const Desc& desc = node_.inputs[port.name].desc;
        const bool texture = desc.kind < ResourceKind::Buffer;
        if (texture && formatInfo(desc.format).channels < port.content.channels)
            note(port.name,
                 fmt::format("is {}, of which {} channels are read", describe(desc), port.content.channels));
        if (port.sameExtentAs.empty() || !node_.inputs.connected(port.sameExtentAs)) return;
        const Desc& other = node_.inputs[port.sameExtentAs].desc;
        if (desc.extent != other.extent || desc.view.source != other.view.source)
            note(port.name,
                 fmt::format("is {} but {} is {}", describe(desc), port.sameExtentAs, describe(other)));
    }

    void checkOutput(const Output& output) {
        const PortInfo* info = known(output.port, "declares the output");
        if (info == nullptr) return;
        if (info->direction == PortDirection::Input) {
            note(output.port, "is an input and cannot be declared as an output");
            return;
        }
        const int meanings = (output.same.empty() ? 0 : 1) + (output.updates.empty() ? 0 : 1) +
                             (output.constant ? 1 : 0) + (output.clear ? 1 : 0);
        if (meanings > 1) note(output.port, "can be only one of same, updates, constant and clear");
        if (!output.same.empty()) checkLikeness(output, *info, output.same);
        if (!output.updates.empty()) checkLikeness(output, *info, output.updates);
        const ResourceKind kind = output.desc.kind;
        const bool fits = isModule(info->kind)             ? kind == ResourceKind::Module
                          : info->kind == PortKind::Buffer ? kind == ResourceKind::Buffer
                                                           : kind < ResourceKind::Buffer;
        if (!fits) {
            note(output.port, fmt::format("is a {} port, but a {} is declared", portKindName(info->kind),
                                          describe(output.desc)));
            return;
        }
        if (kind < ResourceKind::Buffer && output.same.empty() &&
            formatInfo(output.desc.format).channels < info->content.channels)
            note(output.port, fmt::format("is to have {} channels, but is {}", info->content.channels,
                                          describe(output.desc)));
        if (info->kind == PortKind::Layers && output.same.empty() && output.desc.depthLayers.count < 1)
            note(output.port, "does not say how many depth layers a texel holds");
        if (isModule(info->kind) && output.same.empty() && findModule(declaration_, output.port) == nullptr)
            note(output.port, "no module file is declared for it");
        if (!isModule(info->kind)) checkSize(output);
        if (!output.counter.empty()) checkCounter(output);
        if (output.same.empty() && output.updates.empty()) checkView(output);
    }

    void checkCounter(const Output& output) {
        if (known(output.counter, "counts by") == nullptr) return;
        const Output* counter = findOutput(declaration_, output.counter);
        if (counter == nullptr || counter->desc.kind != ResourceKind::Buffer || counter->desc.bytes < 4)
            note(output.port, fmt::format("its counter '{}' is no buffer that is declared", output.counter));
        else if (!counter->clear)
            note(output.port,
                 fmt::format("its counter '{}' has no clear value to count from", output.counter));
        if (output.capacity == 0) note(output.port, "has a counter, but no capacity");
    }

    // Whether the scene has what the view looks from.
    void checkView(const Output& output) {
        const View& view = output.desc.view;
        const SceneFacts& facts = network_.world.facts;
        if (const auto* of = std::get_if<CameraView>(&view.source)) {
            const auto& names = facts.cameras;
            if (!of->name.empty() && std::find(names.begin(), names.end(), of->name) == names.end())
                note(output.port, fmt::format("is seen by camera '{}', which the scene has not{}", of->name,
                                              didYouMean(of->name, names)));
            if (of->name.empty() && (of->camera < 0 || static_cast<size_t>(of->camera) >= names.size()))
                note(output.port,
                     fmt::format("is seen by camera {}; the scene has {}", of->camera, names.size()));
        }
        if (const auto* of = std::get_if<CubeView>(&view.source)) {
            if (of->face < 0 || of->face > 5)
                note(output.port, fmt::format("is seen by face {} of a cube, which has 0 to 5", of->face));
            if (!(of->nearPlane > 0) || (of->farPlane > 0 && !(of->farPlane > of->nearPlane)))
                note(output.port, fmt::format("is seen from {} to {}, which is no range of distances",
                                              of->nearPlane, of->farPlane));
        }
        if (const auto* of = std::get_if<LightView>(&view.source)) {
            if (of->light < 0 || static_cast<std::uint32_t>(of->light) >= facts.lights())
                note(output.port,
                     fmt::format("is seen by light {}; the scene has {}", of->light, facts.lights()));
            if (of->face < 0 || of->face > 5)
                note(output.port,
                     fmt::format("is seen by face {} of a light, which has at most 0 to 5", of->face));
        }
    }

    void checkLikeness(const Output& output, const PortInfo& info, const std::string& input) {
        const PortInfo* other = known(input, "refers to");
        if (other == nullptr) return;
        if (other->direction != PortDirection::Input || other->kind != info.kind)
            note(output.port, fmt::format("cannot be '{}', which is not an input of its kind", input));
        else if (!node_.inputs.connected(input))
            note(output.port, fmt::format("refers to the input '{}', which is not connected", input));
    }

    void checkSize(const Output& output) {
        const Desc& desc = output.desc;
        if (desc.kind == ResourceKind::Buffer) {
            if (desc.bytes == 0) note(output.port, "the buffer has no bytes");
            return;
        }
        const Extent& e = desc.extent;
        if (desc.format == Format::None) note(output.port, "the texture has no format");
        if (e.width == 0 || e.height == 0 || e.depth == 0 || desc.mips < 1)
            note(output.port, fmt::format("the texture {} is empty", describe(desc)));
        const Capabilities& caps = network_.world.capabilities;
        const bool volume = desc.kind == ResourceKind::Texture3D;
        const auto side = static_cast<std::uint32_t>(volume ? caps.max3DTextureSize : caps.maxTextureSize);
        const auto layers = static_cast<std::uint32_t>(volume ? caps.max3DTextureSize : caps.maxArrayLayers);
        if (e.width > side || e.height > side || e.depth > layers)
            noteLimit(output.port,
                      fmt::format("the texture {} is larger than the device allows ({} a side, {} {})",
                                  describe(desc), side, layers, volume ? "deep" : "layers"));
    }

    void checkModule(const Module& module) {
        const PortInfo* info = known(module.port, "declares the module");
        if (info != nullptr && (info->direction != PortDirection::Output || !isModule(info->kind)))
            note(module.port, "is no output for a module");
        if (module.shader.empty()) note(module.port, "the module has no file");
        const std::string what = fmt::format("the module '{}'", module.port);
        for (const Use& use : module.uses) checkUse(use, what);
        if (demand_.reads(module.port))
            for (const ModuleUse& use : module.modules) checkModuleUse(use, what);
    }

    void checkStep(const Step& step) {
        const std::string what = fmt::format("the step '{}'", step.name);
        for (const Use& use : step.uses) checkUse(use, what);
        for (const ModuleUse& use : step.modules) checkModuleUse(use, what);
        // Reading what the same draw renders to is undefined in OpenGL, except other mips.
        for (const Use& target : step.uses)
            for (const Use& read : step.uses)
                if (target.access == Access::Attachment && read.access == Access::Fetch &&
                    target.port == read.port && !read.previous && (read.mip < 0 || read.mip == target.mip))
                    note(read.port, fmt::format("{} reads the texture that it renders to", what));
    }

    void checkUse(const Use& use, const std::string& what) {
        const PortInfo* info = known(use.port, what + " uses");
        if (info == nullptr) return;
        if (isModule(info->kind)) {
            note(use.port, fmt::format("{} uses a module like a resource", what));
            return;
        }
        const bool input = info->direction == PortDirection::Input;
        const Output* output = findOutput(declaration_, use.port);
        if (input && !node_.inputs.connected(use.port)) {
            note(use.port, fmt::format("{} reads it, but it is not connected", what));
            return;
        }
        if (input && use.write) {
            note(use.port, fmt::format("{} writes an input; an output that updates it is needed", what));
            return;
        }
        if (!input && output == nullptr) {
            note(use.port, fmt::format("{} uses it, but no output is declared for it", what));
            return;
        }
        if (use.write && use.previous)
            note(use.port, fmt::format("{} writes the content of the last frame", what));
        checkAccess(use, input ? node_.inputs[use.port].desc : output->desc, what);
    }

    void checkAccess(const Use& use, const Desc& desc, const std::string& what) {
        const bool buffer = desc.kind == ResourceKind::Buffer;
        const bool ofTextures = use.access == Access::Attachment;
        const bool ofBuffers = use.access == Access::Storage || use.access == Access::Uniform ||
                               use.access == Access::Vertex || use.access == Access::Indirect;
        if ((buffer && ofTextures) || (!buffer && ofBuffers))
            note(use.port, fmt::format("{} uses a {} by {}", what, buffer ? "buffer" : "texture",
                                       accessName(use.access)));
        if (buffer && desc.format == Format::None &&
            (use.access == Access::Fetch || use.access == Access::Image))
            note(use.port, fmt::format("{} reads texels of a buffer that has no texel format", what));
        if (use.mip >= desc.mips)
            note(use.port, fmt::format("{} uses mip {} of {}", what, use.mip, desc.mips));
        if (use.layer >= 0 && (buffer || (use.access != Access::Attachment && use.access != Access::Image)))
            note(use.port, fmt::format("{} uses layer {} {} by {}, which has no layers", what, use.layer,
                                       buffer ? "of a buffer" : "of a texture", accessName(use.access)));
        else if (use.layer >= desc.layers(use.mip))
            note(use.port, fmt::format("{} uses layer {} of {}", what, use.layer, desc.layers(use.mip)));
        if (use.write && (use.access == Access::Fetch || use.access == Access::Uniform ||
                          use.access == Access::Vertex || use.access == Access::Indirect))
            note(use.port, fmt::format("{} writes by {}", what, accessName(use.access)));
        const auto limit = static_cast<std::uint64_t>(network_.world.capabilities.maxStorageBlockBytes);
        if (use.access == Access::Storage && desc.bytes > limit)
            noteLimit(use.port, fmt::format("{} needs a storage block of {} bytes; the device allows {}",
                                            what, desc.bytes, limit));
        const auto texels = static_cast<std::uint64_t>(network_.world.capabilities.maxTextureBufferTexels);
        if (buffer && desc.format != Format::None &&
            (use.access == Access::Fetch || use.access == Access::Image) &&
            desc.bytes / static_cast<std::uint64_t>(formatInfo(desc.format).bytes) > texels)
            noteLimit(use.port,
                      fmt::format("{} needs a texel buffer of {} bytes ({}); the device allows {} texels",
                                  what, desc.bytes, formatInfo(desc.format).name, texels));
    }

    // What is provided and requested.
    void checkModuleUse(const ModuleUse& use, const std::string& what) {
        const PortInfo* info = known(use.port, what + " includes");
        if (info == nullptr) return;
        if (info->direction != PortDirection::Input || !isModule(info->kind)) {
            note(use.port, fmt::format("{} includes it, but it is no module input", what));
            return;
        }
        if (!node_.inputs.connected(use.port)) {
            note(use.port, fmt::format("{} includes it, but it is not connected", what));
            return;
        }
        const Bits given = node_.inputs[use.port].desc.provides;
        const std::string producer = network_.text(*originOfInput(network_, index_, use.port));
        const bool traces = info->kind == PortKind::Tracer || info->kind == PortKind::Hits;
        if (traces && (use.requests & requests::Surface) != 0 && (given & provides::Surface) == 0)
            note(use.port, fmt::format("'{}' needs normals and materials at hits, which '{}' does not give",
                                       node_.name(), producer));
        if (info->kind == PortKind::Layers && (use.requests & requests::Surface) != 0 &&
            (given & provides::Surface) == 0)
            note(use.port, fmt::format("'{}' needs the triangles of samples, which '{}' does not give",
                                       node_.name(), producer));
        if ((given & provides::AlwaysSnaps) != 0 && (use.requests & requests::Snap) == 0)
            note(use.port,
                 fmt::format("'{}' needs the exact direction, but '{}' always snaps to a nearby one",
                             node_.name(), producer));
    }

    // A demanded output that nothing writes would be read as garbage.
    void checkWritten(const Output& output) {
        if (!demand_.reads(output.port) || output.constant || !output.same.empty() ||
            output.desc.kind == ResourceKind::Module)
            return;
        const PortInfo* info = node_.type->port(output.port);
        if (info == nullptr || info->direction != PortDirection::Output) return;
        const auto writes = [&](const std::vector<Use>& uses) {
            return std::any_of(uses.begin(), uses.end(),
                               [&](const Use& use) { return use.write && use.port == output.port; });
        };
        const bool byStep = std::any_of(declaration_.steps.begin(), declaration_.steps.end(),
                                        [&](const Step& step) { return writes(step.uses); });
        const bool byModule = std::any_of(declaration_.modules.begin(), declaration_.modules.end(),
                                          [&](const Module& module) { return writes(module.uses); });
        if (!byStep && (!byModule || !output.updates.empty()))
            note(output.port, "no step writes this output");
    }

    const Network& network_;
    const int index_;
    const Node& node_;
    const Declaration& declaration_;
    const Demand& demand_;
    std::vector<DeclarationProblem> problems_;
};

} // namespace

std::vector<DeclarationProblem> checkDeclaration(const Network& network, int node,
                                                 const Declaration& declaration, const Demand& demand) {
    return Checker(network, node, declaration, demand).run();
}

} // namespace kestrel::compiler
