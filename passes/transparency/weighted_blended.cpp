#include "weighted_blended.h"
#include "blended_layers.h"
#include "blended_light.h"
#include "execute/commands.h"

namespace kestrel {

PassType WeightedBlended::type() {
    Describe<WeightedBlended> table("WeightedBlended",
                                    "Blended materials over an opaque picture as a weighted "
                                    "mean, whatever their order");
    return addBlended(table)
        .output("result", PortKind::Texture, "Radiance with the blended surfaces; a: how much is covered")
        .carries({.channels = 4})
        .internal("weighted", PortKind::Texture, "Sums of weighted colour and alpha")
        .internal("through", PortKind::Texture, "Sum of the logarithms of what the surfaces let through")
        .choice("weight", &WeightedBlended::weight,
                {"none", "equation_7", "equation_8", "equation_9", "equation_10"},
                "By alpha and depth, as the paper numbers them; none: all alike")
        .number("scale", &WeightedBlended::scale, 1e-6, 1e6, "",
                "Of depths for equations 7 to 9, which expect 0.1 to 500")
        .vector("ambient", &WeightedBlended::ambient, 0, 1e9, "radiance",
                "Light from all sides besides the radiance: base colour times this, but of metals");
}

Declaration WeightedBlended::declare(const World& world, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    const Desc& picture = inputs["picture"].desc;
    declaration.outputs = {
        {.port = "result", .desc = Desc::texture2D(Format::RGBA32F, picture.extent, picture.view)}};
    if (leavesOutBlended(world, declaration)) return declaration;
    checkBlendedView(inputs["depth"].desc, declaration);
    // The paper has half floats and 8 bits; sums of many surfaces are exact here.
    for (const auto& [port, format] : {std::pair{"weighted", Format::RGBA32F}, {"through", Format::R32F}})
        declaration.outputs.push_back({.port = port,
                                       .desc = Desc::texture2D(format, picture.extent, picture.view),
                                       .clear = glm::vec4(0)});

    Step draw = blendedStep(world, "draw", "transparency/weighted.frag");
    draw.run = &WeightedBlended::draw;
    draw.uses.push_back({.port = "weighted", .access = Access::Attachment, .write = true});
    draw.uses.push_back({.port = "through", .access = Access::Attachment, .write = true});
    lightBlended(world, inputs, ambient, draw);
    constexpr const char* equations[] = {"0", "7", "8", "9", "10"};
    draw.defines.emplace("EQUATION", equations[static_cast<int>(weight)]);
    declaration.steps = {
        std::move(draw),
        {.name = "resolve",
         .run = [extent = picture.extent](Commands& commands) { commands.dispatchOver(extent); },
         .shaders = {"transparency/resolve.comp"},
         .uses = {{.port = "picture", .access = Access::Fetch},
                  {.port = "weighted", .access = Access::Fetch},
                  {.port = "through", .access = Access::Fetch},
                  {.port = "result", .access = Access::Image, .write = true}},
         .group = "composite"}};
    declaration.depends = blendedCauses;
    return declaration;
}

void WeightedBlended::draw(Commands& commands) const {
    if (ambient != glm::vec3(0)) commands.set("ambient", ambient);
    commands.set("scale", scale);
    DrawState state = DrawState::overwrite();
    state.cull = Cull::Back;
    state.blend = Blend::Add;
    commands.drawScene(state, blendedClasses());
}

} // namespace kestrel
