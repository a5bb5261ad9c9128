#include "screen_trace.h"
#include "execute/commands.h"
#include "shared/near_field.h"

namespace kestrel {

PassType ScreenTrace::type() {
    return Describe<ScreenTrace>("ScreenTrace", "Marches rays over the pixels of a depth buffer")
        .input("depth", PortKind::Texture, "Reversed depth of the visible surfaces")
        .carries(content::depth)
        .output("tracer", PortKind::Tracer, "Hits what the image shows; everything else is missed")
        .internal("settings", PortKind::Buffer, "How rays are marched (shared/near_field.h)")
        .number("steps", &ScreenTrace::steps, 1, 1024, "samples", "Samples along a ray; then it is a miss")
        .number("stride", &ScreenTrace::stride, 1, 64, "pixels", "From one sample to the next")
        .flag("jitter", &ScreenTrace::jitter,
              "Shifts the samples by up to a stride, differently for each pixel and frame")
        .number(
            "thickness", &ScreenTrace::thickness, 0, 10, "view heights",
            "How far behind the visible surface there still is something to hit, in heights of what the eye "
            "sees at its distance: the extent of the scene does not count")
        .number("offset", &ScreenTrace::offset, 0, 16, "pixels",
                "How far ray origins are moved off the surface along its normal, in widths of a pixel there");
}

Declaration ScreenTrace::declare(const World&, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    declaration.outputs = {{.port = "tracer", .desc = Desc::module(provides::Approximate)}};
    if (!demand.reads("tracer")) return declaration;
    Module tracer{.port = "tracer", .shader = "near_field/screen_trace.glsl"};
    if (inputs["depth"].constant == glm::vec4(0)) {
        tracer.defines.emplace("EMPTY", "1");
        declaration.leftOut.push_back({"marching", "the depth is empty everywhere"});
        declaration.modules.push_back(std::move(tracer));
        return declaration;
    }
    tracer.defines.emplace("STEPS", std::to_string(steps));
    tracer.uses = {{.port = "depth", .access = Access::Fetch},
                   {.port = "settings", .access = Access::Uniform}};
    if (jitter && stride > 1) {
        tracer.defines.emplace("JITTER", "1");
        declaration.depends = Causes::Frame;
    } else if (jitter) {
        declaration.leftOut.push_back({"jitter", "no pixel lies between the samples"});
    }
    declaration.modules.push_back(std::move(tracer));
    declaration.outputs.push_back(
        {.port = "settings", .desc = Desc::buffer(sizeof(shared::ScreenTraceSettings))});
    declaration.steps.push_back(
        {.name = "settings", .uses = {{.port = "settings", .access = Access::Copy, .write = true}}});
    declaration.depends |= Causes::Properties;
    return declaration;
}

void ScreenTrace::execute(const Step&, Commands& commands) {
    commands.uploadValue("settings", shared::ScreenTraceSettings{stride, thickness, offset, 0});
}

} // namespace kestrel
