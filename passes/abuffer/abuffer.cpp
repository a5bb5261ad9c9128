#include "abuffer.h"
#include "block_bounds.h"
#include "execute/commands.h"
#include "execute/exhausted_rays.h"
#include "fragment_layers.h"
#include "primitive_records.h"
#include "views.h"
#include <bit>
#include <fmt/format.h>

namespace kestrel {

namespace {

// Iterations of one invocation, all its rays together: what every driver runs (shader/iterations.h), less
// what others of its group make in step with it.
constexpr int budget = 24'000;

std::string floatText(double value) {
    return fmt::format("uintBitsToFloat({}u)", std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}

} // namespace

PassType ABuffer::type() {
    Describe<ABuffer> table("ABuffer", "Traces rays through the pixels of an A-buffer, view after view");
    return addPrimitiveRecords(table)
        .input("pixels", PortKind::Buffer, "What each pixel of each view knows of its list")
        .input("nodes", PortKind::Buffer, "The nodes, sorted and linked")
        .input("data", PortKind::Buffer, "The triangle of each node, where data is decoupled")
        .output("tracer", PortKind::Tracer, "The nearest fragment or primitive along a ray")
        .output("layers", PortKind::Layers,
                "The fragments of the frame's view at a pixel, nearest first, with their triangles")
        .output("hits", PortKind::Hits, "Every fragment or primitive along a ray")
        .internal("block_bounds", PortKind::Buffer, "Depth bounds of blocks of pixels")
        .internal("exhausted", PortKind::Buffer, "Rays traced, and those that ran out of iterations")
        .choice(
            "record", &ABuffer::record, {"fragment", "primitive"},
            "What a ray meets in a pixel: the stored fragments, as thick as `thickness` says, or the "
            "triangles "
            "that touch the pixel, which the pass finds itself in the views and buckets of the store, by an "
            "exact test")
        .choice(
            "march", &ABuffer::march, {"exhaustive", "fixed", "hierarchical"},
            "Through every pixel on the way, through `steps` of them in each view, or over blocks of pixels "
            "that the ray does not meet (with `skipping`; changes no hit)")
        .number("steps", &ABuffer::steps, 1, 4096, "pixels", "Of each view that a ray looks at, with `fixed`")
        .choice("layering", &ABuffer::layering, {"multi", "single"},
                "All fragments, or the nearest of each pixel alone; of primitives all")
        .flag("skipping", &ABuffer::skipping,
              "Passes pixels and buckets whose depths a ray does not have; changes no hit")
        .number("thickness", &ABuffer::thickness, 0, 100, "pixel footprints",
                "Of a fragment, along the view's axis, about its plane where the store keeps planes and "
                "about its depth at the pixel's centre where it does not; of no primitive")
        .number("offset", &ABuffer::offset, 0, 100, "pixel footprints",
                "By which rays start off their surface, with fragments")
        .flag("count_exhausted", &ABuffer::countExhausted, "Reports how many rays ran out of iterations");
}

Declaration ABuffer::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    const FragmentLists& lists = inputs["nodes"].desc.lists;
    const bool primitive = record == ABufferRecord::Primitive;
    const Bits given = provides::Surface | (primitive ? 0 : provides::Approximate);
    for (const char* port : {"tracer", "hits"})
        if (demand.reads(port)) {
            Desc desc = Desc::module(given);
            desc.lists = lists; // consumers that trace several rays at once need to know
            declaration.outputs.push_back({.port = port, .desc = desc});
        }
    declaration.depends = Causes::Properties;
    declareFragmentLayers(world, inputs, demand, declaration);
    if (!demand.reads("tracer") && !demand.reads("hits")) return declaration;
    const char* empty = inputs["nodes"].constant || world.facts.triangles == 0 ? "there are no fragments"
                        : abufferPixels(lists, world.size) == 0 ? "there is no view to march in"
                                                                : nullptr;
    if (empty != nullptr) {
        declareEmpty(declaration, demand, empty);
        return declaration;
    }
    std::vector<Module> modules;
    for (const char* port : {"tracer", "hits"})
        if (demand.reads(port)) modules.push_back(moduleOf(port, world, lists));
    std::vector<Use> read = {{.port = "pixels", .access = Access::Image},
                             {.port = "nodes", .access = Access::Image}};
    if (primitive) {
        read = declarePrimitiveRecords(declaration, world, lists, demand);
        declaration.leftOut.push_back({"fragments", "`record` primitive keeps triangles in place of them"});
        declaration.depends |=
            Causes::Camera | Causes::Cut | Causes::Geometry | Causes::Transforms | Causes::Size;
    }
    if (hierarchical())
        declareBlockBounds(declaration, world, lists, primitive,
                           primitive ? std::vector<Use>{read.front()} : read);
    if (march == ABufferMarching::Hierarchical && !skipping)
        declaration.leftOut.push_back({"blocks of pixels", "nothing is to be skipped"});
    Step clear{.name = "clear", .run = [](Commands& commands) { exhaustion::clear(commands); }};
    for (Module& module : modules) {
        module.uses = read;
        if (hierarchical()) module.uses.push_back({.port = "block_bounds", .access = Access::Image});
        if (!primitive && lists.decoupled && module.port == "tracer" &&
            (demand.requests("tracer") & requests::Surface) != 0)
            module.uses.push_back({.port = "data", .access = Access::Image});
        if (!countExhausted) continue;
        if (&module == &modules.front()) {
            exhaustion::declare(declaration, module, clear);
        } else {
            module.defines.emplace("COUNT_EXHAUSTED", "1");
            module.uses.push_back({.port = "exhausted", .access = Access::Storage, .write = true});
        }
    }
    if (countExhausted) declaration.steps.push_back(std::move(clear));
    for (Module& module : modules) declaration.modules.push_back(std::move(module));
    return declaration;
}

Module ABuffer::moduleOf(const char* port, const World& world, const FragmentLists& lists) const {
    const bool primitive = record == ABufferRecord::Primitive;
    Module module{.port = port,
                  .shader = primitive ? "abuffer/primitives.glsl" : "abuffer/abuffer.glsl",
                  .defines = abufferDefines(lists, world.size)};
    module.defines.emplace(std::string(port) == "hits" ? "PROVIDES_HITS" : "PROVIDES_TRACER", "1");
    module.defines.emplace("LEVELS", std::to_string(hierarchical() ? blockLevels : 1));
    module.defines.emplace("SAMPLES", std::to_string(march == ABufferMarching::Fixed ? steps : 0));
    module.defines.emplace("BUDGET", std::to_string(budget));
    if (skipping) module.defines.emplace("SKIPPING", "1");
    if (primitive) {
        if (world.facts.hasMasked) module.defines.emplace("MATERIAL_MASKED", "1");
        return module;
    }
    if (layering == ABufferLayering::Single) module.defines.emplace("SINGLE_LAYER", "1");
    module.defines.emplace("THICKNESS", floatText(thickness));
    module.defines.emplace("OFFSET", floatText(offset));
    return module;
}

void ABuffer::declareEmpty(Declaration& declaration, const Demand& demand, const char* why) {
    declaration.leftOut.push_back({"marching", why});
    for (const char* port : {"tracer", "hits"}) {
        if (!demand.reads(port)) continue;
        const char* provides = std::string(port) == "hits" ? "PROVIDES_HITS" : "PROVIDES_TRACER";
        declaration.modules.push_back(
            {.port = port, .shader = "abuffer/empty.glsl", .defines = {{provides, "1"}}});
    }
}

} // namespace kestrel
