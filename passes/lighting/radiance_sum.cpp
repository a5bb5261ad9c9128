#include "radiance_sum.h"
#include "execute/commands.h"

namespace kestrel {

PassType RadianceSum::type() {
    return Describe<RadianceSum>("RadianceSum", "Adds what several sources of radiance give")
        .input("first", PortKind::Radiance, "One source")
        .input("second", PortKind::Radiance, "Another")
        .optionalInput("third", PortKind::Radiance, "A third")
        .optionalInput("fourth", PortKind::Radiance, "A fourth")
        .output("radiance", PortKind::Radiance, "Their sum; it needs of hits what any of them needs");
}

Declaration RadianceSum::declare(const World&, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    Module module{.port = "radiance", .shader = "lighting/radiance_sum.glsl"};
    Bits required = 0;
    for (const auto& [port, define] :
         {std::pair{"first", "FIRST"}, {"second", "SECOND"}, {"third", "THIRD"}, {"fourth", "FOURTH"}}) {
        if (!inputs.connected(port)) continue;
        required |= inputs[port].desc.required;
        module.defines.emplace(define, "1");
        module.modules.push_back({port, 0});
    }
    declaration.outputs = {{.port = "radiance", .desc = Desc::module(0, required)}};
    declaration.modules.push_back(std::move(module));
    return declaration;
}

} // namespace kestrel
