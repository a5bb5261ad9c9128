#include "bvh_pass.h"
#include "execute/commands.h"
#include "graph/many_rays.h"
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
// How many times as many visits as a new tree's a fitted one may cost.
constexpr double mostWorse = 1.3;

std::uint64_t itemBytes(std::uint64_t triangles) { return mostWideItems(triangles) * sizeof(WideItem); }

} // namespace

PassType BvhPass::type() {
    return Describe<BvhPass>(
               "Bvh", "Bounding volume hierarchy over the triangles, built on the CPU, traversed in GLSL")
        .output("tracer", PortKind::Tracer, "Exact visibility and closest hits")
        .output("hits", PortKind::Hits, "Every hit along a ray")
        .internal("items", PortKind::Buffer, "Nodes and triangles of the wide layout (shared/wide_bvh.h)")
        .internal("nodes", PortKind::Buffer, "Inner nodes of the binary layout (shared/bvh.h)")
        .internal("triangles", PortKind::Buffer,
                  "Triangles of the binary layout in the order of the leaves (shared/bvh.h)")
        .choice(
            "layout", &BvhPass::layout, {"wide", "binary"},
            "wide: four children a node, quantized boxes, single triangles; binary: exact boxes, the plain "
            "form. The hits are the same to the bit")
        .number("leaf", &BvhPass::leaf, 1, 15, "triangles", "Most triangles in a leaf of the binary layout")
        .number("bins", &BvhPass::bins, 2, 32, "", "Candidate splits an axis in the surface area heuristic");
}

Declaration BvhPass::declare(const World& world, const Inputs&, const Demand& demand) const {
    Declaration declaration;
    const std::uint64_t triangles = world.facts.triangles;
    const bool wide = layout == Layout::Wide;
    std::vector<std::pair<const char*, std::uint64_t>> buffers;
    if (wide)
        buffers = {{"items", itemBytes(triangles)}};
    else
        buffers = {{"nodes", nodeBytes(triangles)}, {"triangles", triangleBytes(triangles)}};
    const auto limit = static_cast<std::uint64_t>(world.capabilities.maxTextureBufferTexels);
    // imageBuffer is the fastest random read on a CPU driver.
    std::vector<Use> reads, writes;
    std::uint64_t most = 0;
    for (const auto& [port, bytes] : buffers) {
        declaration.outputs.push_back({.port = port, .desc = Desc::buffer(bytes, Format::RGBA32UI)});
        reads.push_back({.port = port, .access = Access::Image});
        writes.push_back({.port = port, .access = Access::Copy, .write = true});
        most = std::max(most, bytes / texelBytes);
    }
    if (most > limit)
        declaration.problems.push_back(
            {"",
             fmt::format("{} triangles need {} texels in a buffer texture; the limit is {}", triangles, most,
                         limit),
             true});

    const auto provide = [&](const char* port, const char* define, Bits given) {
        declaration.outputs.push_back({.port = port, .desc = Desc::module(given)});
        Module module{.port = port,
                      .shader = wide ? "bvh/wide.glsl" : "bvh/bvh.glsl",
                      .defines = {{define, "1"}},
                      .uses = reads};
        if (world.facts.hasMasked) module.defines.emplace("MATERIAL_MASKED", "1");
        declaration.modules.push_back(std::move(module));
    };
    if (demand.reads("tracer"))
        provide("tracer", "PROVIDES_TRACER",
                provides::Surface | (wide ? provides::ManyRays | provides::ManyClosest : 0));
    if (demand.reads("hits")) provide("hits", "PROVIDES_HITS", provides::Surface);
    // In what order all hits of a ray are visited hangs on the tree, so that where they are read it is one of
    // this frame alone.
    declaration.steps.push_back({.name = "build",
                                 .run = {&BvhPass::build, wide && !demand.reads("hits")},
                                 .uses = writes,
                                 .group = "generation"});
    if (!world.facts.hasMasked)
        declaration.leftOut.push_back({"alpha test at hits", "no material is masked or blended"});
    declaration.depends = Causes::Geometry | Causes::Transforms | Causes::Materials | Causes::Properties;
    return declaration;
}

// Whether what was built for an earlier frame, of the same triangles, has been fitted to this one's and is
// still good.
bool BvhPass::refits(Commands& commands) {
    const Geometry& geometry = commands.geometry();
    const bool moved = !any(commands.causes() & ~(Causes::Frame | Causes::Camera | Causes::Cameras |
                                                  Causes::Lights | Causes::Geometry | Causes::Transforms));
    if (!moved || geometry.triangleCount() != triangles_) return false;
    refit(moving_, geometry);
    return expectedVisits(moving_) <= mostWorse * builtVisits_;
}

void BvhPass::build(Commands& commands, bool mayRefit) {
    const Geometry& geometry = commands.geometry();
    if (layout == Layout::Binary) {
        const Bvh bvh = buildBvh(geometry, {.maxLeaf = leaf, .bins = bins});
        commands.upload("nodes", bvh.nodes);
        commands.upload("triangles", bvh.triangles);
        return;
    }
    if (geometry.moving.empty() || !mayRefit) {
        moving_ = {};
        triangles_ = noTriangles;
        commands.upload("items", widened(buildBvh(geometry, {.maxLeaf = 1, .bins = bins})).items);
        return;
    }
    ++refits_;
    if (!refits(commands)) {
        moving_ = widened(buildBvh(geometry, {.maxLeaf = 1, .bins = bins}));
        triangles_ = geometry.triangleCount();
        builtVisits_ = expectedVisits(moving_);
        refits_ = 0;
    }
    commands.upload("items", moving_.items);
    commands.report("refits since building", refits_);
}

} // namespace kestrel
