#include "abuffer.h"
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
        .internal("exhausted", PortKind::Buffer, "Rays traced, and those that ran out of iterations")
        .choice(
            "record", &ABuffer::record, {"fragment", "primitive"},
            "What a ray meets in a pixel: the stored fragments, as thick as `thickness` says, or the "
            "triangles "
            "that touch the pixel, which the pass finds itself in the views and buckets of the store, by an "
            "exact test")
        .flag("skipping", &ABuffer::skipping,
              "Passes pixels and buckets whose depths a ray does not have; changes no hit")
        .number("thickness", &ABuffer::thickness, 0, 100, "pixel footprints",
                "Of a fragment, along the view's axis; of no primitive")
        .number("offset", &ABuffer::offset, 0, 100, "pixel footprints",
                "By which rays start off their surface, with fragments")
        .flag("count_exhausted", &ABuffer::countExhausted, "Reports how many rays ran out of iterations");
}

Declaration ABuffer::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    const FragmentLists& lists = inputs["nodes"].desc.lists;
    const bool primitive = record == ABufferRecord::Primitive;
    declaration.outputs.push_back(
        {.port = "tracer",
         .desc = Desc::module(provides::Surface | (primitive ? 0 : provides::Approximate))});
    Module tracer{.port = "tracer",
                  .shader = primitive ? "abuffer/primitives.glsl" : "abuffer/abuffer.glsl",
                  .defines = abufferDefines(lists, world.size)};
    if (inputs["nodes"].constant ||
        (primitive && (world.facts.triangles == 0 || abufferPixels(lists, world.size) == 0))) {
        tracer.shader = "abuffer/abuffer.glsl";
        tracer.defines.emplace("EMPTY", "1");
        declaration.leftOut.push_back({"marching", "there are no fragments"});
    } else {
        if (primitive) {
            declarePrimitiveRecords(declaration, tracer, world, lists, demand);
            tracer.defines.emplace("PROVIDES_TRACER", "1");
            if (world.facts.hasMasked) tracer.defines.emplace("MATERIAL_MASKED", "1");
            declaration.leftOut.push_back(
                {"fragments", "`record` primitive keeps triangles in place of them"});
            declaration.depends =
                Causes::Camera | Causes::Cut | Causes::Geometry | Causes::Transforms | Causes::Size;
        } else {
            declareFragments(declaration, inputs, demand, tracer);
        }
        tracer.defines.emplace("BUDGET", std::to_string(budget));
        if (skipping) tracer.defines.emplace("SKIPPING", "1");
        if (countExhausted) {
            Step clear{.name = "clear", .run = [](Commands& commands) { exhaustion::clear(commands); }};
            exhaustion::declare(declaration, tracer, clear);
            declaration.steps.push_back(std::move(clear));
        }
    }
    declaration.modules.push_back(std::move(tracer));
    declareFragmentLayers(world, inputs, demand, declaration);
    declaration.depends = declaration.depends | Causes::Properties;
    return declaration;
}

void ABuffer::declareFragments(Declaration&, const Inputs& inputs, const Demand& demand,
                               Module& tracer) const {
    tracer.uses = {{.port = "pixels", .access = Access::Image}, {.port = "nodes", .access = Access::Image}};
    if (inputs["nodes"].desc.lists.decoupled && (demand.requests("tracer") & requests::Surface) != 0)
        tracer.uses.push_back({.port = "data", .access = Access::Image});
    tracer.defines.emplace("THICKNESS", floatText(thickness));
    tracer.defines.emplace("OFFSET", floatText(offset));
}

} // namespace kestrel
