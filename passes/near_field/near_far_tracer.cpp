#include "near_far_tracer.h"
#include "draw/near_scene.h"
#include "execute/commands.h"
#include "graph/many_rays.h"
#include "shared/near_field.h"

namespace kestrel {

PassType NearFarTracer::type() {
    return Describe<NearFarTracer>("NearFarTracer",
                                   "Two tracers: one for what is near along a ray, one beyond")
        .input("near", PortKind::Tracer, "Who answers up to the reach; it is not let snap")
        .input("far", PortKind::Tracer, "Who answers beyond")
        .output("tracer", PortKind::Tracer, "The nearer half's answer; snaps as the far tracer does")
        .internal("settings", PortKind::Buffer, "The reach (shared/near_field.h)")
        .number("reach", &NearFarTracer::reach, 0, 1e9, "scene units or radii",
                "Distance along the ray at which the far tracer takes over; 0: it answers alone")
        .flag("relative", &NearFarTracer::relative,
              "The reach is given in radii of the scene's sphere, or of what the camera sees from near where "
              "the "
              "scene is far wider");
}

Declaration NearFarTracer::declare(const World&, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    const Bits near = inputs["near"].desc.provides;
    const Bits far = inputs["far"].desc.provides;
    if (reach == 0) {
        declaration.outputs = {{.port = "tracer", .desc = Desc::module(far), .same = "far"}};
        declaration.leftOut.push_back({"near tracer", "its reach is 0"});
        return declaration;
    }
    const Bits given = (near & far & provides::Surface) | (near & provides::ManyRays) |
                       ((near | far) & provides::Approximate) |
                       (far & (provides::Snaps | provides::AlwaysSnaps));
    declaration.outputs = {{.port = "tracer", .desc = Desc::module(given)}};
    if (!demand.reads("tracer")) return declaration;

    // Both halves are asked for what the consumers take. A half that always snaps is refused by the framework
    // where nobody bears it, and the near one never bears it.
    Bits taken = demand.requests("tracer") &
                 (requests::AnyHit | requests::ClosestHit | requests::Surface | requests::Snap);
    if ((given & provides::Surface) == 0) taken &= ~requests::Surface;
    // Many rays are the near half's to take at once; the far one has them one by one.
    const Bits many = demand.requests("tracer") & requests::ManyRays;
    const Bits farTaken = taken | (many != 0 ? requests::AnyHit : 0);
    declaration.modules.push_back(
        {.port = "tracer",
         .shader = "near_field/near_far.glsl",
         .uses = {{.port = "settings", .access = Access::Uniform}},
         .modules = {{"near", (taken & ~requests::Snap) | many}, {"far", farTaken}}});
    declaration.outputs.push_back(
        {.port = "settings", .desc = Desc::buffer(sizeof(shared::NearFarSettings))});
    declaration.steps.push_back(
        {.name = "settings", .uses = {{.port = "settings", .access = Access::Copy, .write = true}}});
    declaration.depends = Causes::Properties | Causes::Cut; // another camera sees from another distance
    return declaration;
}

void NearFarTracer::execute(const Step&, Commands& commands) {
    const float unit = relative ? nearScene(commands.facts(), commands.frame().cameraState).radius : 1.0f;
    commands.uploadValue("settings", shared::NearFarSettings{reach * unit, 0, 0, 0});
}

} // namespace kestrel
