#include "bvh_pass.h"
#include "execute/commands.h"
#include "scene/bvh.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel {
namespace {

constexpr std::uint64_t texelBytes = 16;

// Declaring comes before building, so the buffers are made for the most that any build can need: a binary
// tree over leaves of at least one triangle has fewer inner nodes than triangles.
std::uint64_t nodeBytes(std::uint64_t triangles) {
    return std::max<std::uint64_t>(1, triangles) * sizeof(BvhNode);
}
std::uint64_t triangleBytes(std::uint64_t triangles) {
    return std::max<std::uint64_t>(1, triangles) * sizeof(BvhTriangle);
}

} // namespace

PassType BvhPass::type() {
    return Describe<BvhPass>(
               "Bvh", "Bounding volume hierarchy over the triangles, built on the CPU, traversed in GLSL")
        .output("tracer", PortKind::Tracer, "Exact visibility and closest hits")
        .output("hits", PortKind::Hits, "Every hit along a ray")
        .internal("nodes", PortKind::Buffer, "Inner nodes (shared/bvh.h)")
        .internal("triangles", PortKind::Buffer, "Triangles in the order of the leaves (shared/bvh.h)")
        .number("leaf", &BvhPass::leaf, 1, 15, "triangles", "Most triangles in a leaf")
        .number("bins", &BvhPass::bins, 2, 64, "", "Candidate splits an axis in the surface area heuristic");
}

Declaration BvhPass::declare(const World& world, const Inputs&, const Demand& demand) const {
    Declaration declaration;
    const std::uint64_t triangles = world.facts.triangles;
    const std::uint64_t texels = triangleBytes(triangles) / texelBytes;
    const auto limit = static_cast<std::uint64_t>(world.capabilities.maxTextureBufferTexels);
    const std::uint64_t most = std::max(texels, nodeBytes(triangles) / texelBytes);
    if (most > limit)
        declaration.problems.push_back(
            {"",
             fmt::format("{} triangles need {} texels in a buffer texture; the limit is {}", triangles, most,
                         limit),
             true});

    declaration.outputs.push_back(
        {.port = "nodes", .desc = Desc::buffer(nodeBytes(triangles), Format::RGBA32UI)});
    declaration.outputs.push_back(
        {.port = "triangles", .desc = Desc::buffer(triangleBytes(triangles), Format::RGBA32UI)});
    // imageBuffer is the fastest random read on a CPU driver.
    const std::vector<Use> reads = {{.port = "nodes", .access = Access::Image},
                                    {.port = "triangles", .access = Access::Image}};
    const auto provide = [&](const char* port, const char* define, Bits given) {
        declaration.outputs.push_back({.port = port, .desc = Desc::module(given)});
        Module module{.port = port, .shader = "bvh/bvh.glsl", .defines = {{define, "1"}}, .uses = reads};
        if (world.facts.hasMasked) module.defines.emplace("MATERIAL_MASKED", "1");
        declaration.modules.push_back(std::move(module));
    };
    if (demand.reads("tracer")) provide("tracer", "PROVIDES_TRACER", provides::Surface);
    if (demand.reads("hits")) provide("hits", "PROVIDES_HITS", provides::Surface);
    declaration.steps.push_back({.name = "build",
                                 .uses = {{.port = "nodes", .access = Access::Copy, .write = true},
                                          {.port = "triangles", .access = Access::Copy, .write = true}},
                                 .group = "generation"});
    if (!world.facts.hasMasked)
        declaration.leftOut.push_back({"alpha test at hits", "no material is masked or blended"});
    declaration.depends = Causes::Geometry | Causes::Transforms | Causes::Materials | Causes::Properties;
    return declaration;
}

void BvhPass::execute(const Step&, Commands& commands) {
    const Bvh bvh = buildBvh(commands.geometry(), {.maxLeaf = leaf, .bins = bins});
    commands.upload("nodes", bvh.nodes);
    commands.upload("triangles", bvh.triangles);
}

} // namespace kestrel
