#include "abuffer.h"
#include "execute/commands.h"
#include "execute/exhausted_rays.h"
#include "views.h"
#include <bit>
#include <fmt/format.h>

namespace kestrel {

namespace {

// Pixels that a ray passes at most: with the fragments that it meets in them an invocation stays below the
// iterations that every driver runs (shader/iterations.h), with one ray and lists of a few.
constexpr int steps = 20'000;

std::string floatText(double value) {
    return fmt::format("uintBitsToFloat({}u)", std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}

} // namespace

PassType ABuffer::type() {
    return Describe<ABuffer>("ABuffer", "Traces rays through the pixels of an A-buffer, view after view")
        .input("pixels", PortKind::Buffer, "What each pixel of each view knows of its list")
        .input("nodes", PortKind::Buffer, "The nodes, sorted and linked")
        .input("data", PortKind::Buffer, "The triangle of each node, where data is decoupled")
        .output("tracer", PortKind::Tracer, "The nearest fragment along a ray")
        .internal("exhausted", PortKind::Buffer, "Rays traced, and those that ran out of iterations")
        .flag("skipping", &ABuffer::skipping,
              "Passes pixels and buckets whose depths a ray does not have; changes no hit")
        .number("thickness", &ABuffer::thickness, 0, 100, "pixel footprints",
                "Of a fragment, along the view's axis")
        .number("offset", &ABuffer::offset, 0, 100, "pixel footprints",
                "By which rays start off their surface")
        .flag("count_exhausted", &ABuffer::countExhausted, "Reports how many rays ran out of iterations");
}

Declaration ABuffer::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    const FragmentLists& lists = inputs["nodes"].desc.lists;
    declaration.outputs.push_back(
        {.port = "tracer", .desc = Desc::module(provides::Surface | provides::Approximate)});
    Module tracer{
        .port = "tracer", .shader = "abuffer/abuffer.glsl", .defines = abufferDefines(lists, world.size)};
    if (inputs["nodes"].constant) {
        tracer.defines.emplace("EMPTY", "1");
        declaration.leftOut.push_back({"marching", "there are no fragments"});
    } else {
        tracer.uses = {{.port = "pixels", .access = Access::Image},
                       {.port = "nodes", .access = Access::Image}};
        if (lists.decoupled && (demand.requests("tracer") & requests::Surface) != 0)
            tracer.uses.push_back({.port = "data", .access = Access::Image});
        tracer.defines.emplace("STEPS", std::to_string(steps));
        tracer.defines.emplace("THICKNESS", floatText(thickness));
        tracer.defines.emplace("OFFSET", floatText(offset));
        if (skipping) tracer.defines.emplace("SKIPPING", "1");
        if (countExhausted) {
            Step clear{.name = "clear", .run = [](Commands& commands) { exhaustion::clear(commands); }};
            exhaustion::declare(declaration, tracer, clear);
            declaration.steps.push_back(std::move(clear));
        }
    }
    declaration.modules.push_back(std::move(tracer));
    declaration.depends = Causes::Properties;
    return declaration;
}

} // namespace kestrel
