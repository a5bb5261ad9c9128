// Animations of a glTF file.
#include "scene/gltf_context.h"
#include "scene/gltf_schema.h"
#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <optional>
#include <set>

namespace kestrel {
namespace {

std::optional<AnimatedPath> pathOf(const std::string& name) {
    if (name == "translation") return AnimatedPath::Translation;
    if (name == "rotation") return AnimatedPath::Rotation;
    if (name == "scale") return AnimatedPath::Scale;
    if (name == "weights") return AnimatedPath::Weights;
    return std::nullopt;
}

std::optional<Interpolation> interpolationOf(const std::string& name) {
    if (name == "STEP") return Interpolation::Step;
    if (name == "LINEAR" || name.empty()) return Interpolation::Linear;
    if (name == "CUBICSPLINE") return Interpolation::CubicSpline;
    return std::nullopt;
}

size_t targetsOf(const Scene& scene, const Node& node) {
    if (node.mesh < 0) return 0;
    const Mesh& mesh = scene.meshes[static_cast<size_t>(node.mesh)];
    return mesh.primitives.empty() ? 0 : mesh.primitives[0].targets.size();
}

// Why a channel has no effect here, or empty.
std::string reasonToIgnore(const GltfContext& context, const tinygltf::AnimationChannel& source,
                           const tinygltf::AnimationSampler& sampler) {
    const std::optional<AnimatedPath> path = pathOf(source.target_path);
    if (!path) return fmt::format("animations of '{}' are ignored", source.target_path.substr(0, 60));
    if (!interpolationOf(sampler.interpolation))
        return fmt::format("animations with the interpolation '{}' are ignored",
                           sampler.interpolation.substr(0, 60));
    for (const int accessor : {sampler.input, sampler.output})
        if (const std::string* reason = context.accessors.unreadable(accessor))
            return fmt::format("accessors[{}] {}: animations by it are ignored", accessor, *reason);
    const Node& node = context.scene.nodes[static_cast<size_t>(source.target_node)];
    if (*path == AnimatedPath::Weights)
        return targetsOf(context.scene, node) == 0
                   ? "animated weights of nodes without morph targets are ignored"
                   : "";
    return node.matrix ? "animations of nodes with a matrix are ignored" : "";
}

std::vector<float> readTimes(GltfContext& context, int accessor, const std::string& what) {
    std::vector<float> times = context.accessors.floats(accessor, 1, what);
    if (times.front() < 0 && times.front() >= -static_cast<float>(gltfRounding)) {
        context.warn(fmt::format("{} begins at {}, which is read as 0", what, times.front()));
        times.front() = 0;
    }
    if (times.front() < 0) context.fail(what + " begins before 0");
    for (size_t i = 0; i + 1 < times.size(); ++i)
        if (!(times[i] < times[i + 1]))
            context.fail(fmt::format("{} does not rise from element {} to the next", what, i));
    return times;
}

std::optional<AnimationChannel> readChannel(GltfContext& context, const tinygltf::Animation& animation,
                                            const tinygltf::AnimationChannel& source,
                                            const std::string& what) {
    if (source.sampler < 0 || static_cast<size_t>(source.sampler) >= animation.samplers.size())
        context.fail(fmt::format("{}.sampler is {}, but there are {} samplers", what, source.sampler,
                                 animation.samplers.size()));
    const tinygltf::AnimationSampler& sampler = animation.samplers[static_cast<size_t>(source.sampler)];
    if (const std::string reason = reasonToIgnore(context, source, sampler); !reason.empty()) {
        context.warn(reason);
        return std::nullopt;
    }
    AnimationChannel channel;
    channel.node = source.target_node;
    channel.path = *pathOf(source.target_path);
    channel.interpolation = interpolationOf(sampler.interpolation).value_or(Interpolation::Linear);
    context.spend(context.accessors.count(sampler.input), sizeof(float), what);
    channel.times = readTimes(context, sampler.input, what + " input");
    size_t components = channel.path == AnimatedPath::Rotation ? 4 : 3;
    if (channel.path == AnimatedPath::Weights) components = 1;
    context.spend(context.accessors.count(sampler.output), components * sizeof(float), what);
    channel.values = context.accessors.floats(sampler.output, static_cast<int>(components), what + " output");
    if (channel.path == AnimatedPath::Weights)
        components = targetsOf(context.scene, context.scene.nodes[static_cast<size_t>(channel.node)]);
    const size_t wanted =
        channel.times.size() * components * (channel.interpolation == Interpolation::CubicSpline ? 3 : 1);
    if (channel.values.size() != wanted)
        context.fail(fmt::format("{} output has {} values; {} keys need {}", what, channel.values.size(),
                                 channel.times.size(), wanted));
    return channel;
}

} // namespace

void readGltfAnimations(GltfContext& context) {
    std::set<std::pair<int, AnimatedPath>> driven;
    for (size_t i = 0; i < context.model.animations.size(); ++i) {
        const tinygltf::Animation& source = context.model.animations[i];
        // The target of a channel without a node is told by an extension: tinygltf 2.8 drops it, 2.9 has node
        // -1.
        const auto hasNode = [](const tinygltf::AnimationChannel& channel) {
            return channel.target_node >= 0;
        };
        if (static_cast<std::size_t>(std::ranges::count_if(source.channels, hasNode)) <
            context.file.document["animations"][i]["channels"].size())
            context.warn("animations of what is no node are ignored");
        Animation animation;
        animation.name = source.name;
        for (size_t j = 0; j < source.channels.size(); ++j) {
            if (!hasNode(source.channels[j])) continue;
            const std::string what = fmt::format("animations[{}].channels[{}]", i, j);
            std::optional<AnimationChannel> channel = readChannel(context, source, source.channels[j], what);
            if (!channel) continue;
            if (!driven.emplace(channel->node, channel->path).second)
                context.warn(
                    "several animations drive the same property; all play together and the last one wins");
            animation.channels.push_back(std::move(*channel));
        }
        if (!animation.channels.empty()) context.scene.animations.push_back(std::move(animation));
    }
}

} // namespace kestrel
