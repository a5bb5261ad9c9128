#include "gbuffer.h"
#include "draw/material_defines.h"
#include "execute/commands.h"

namespace kestrel {
namespace {

// One colour output: its define switches the writing on in gbuffer.frag.
struct Target {
    const char* port;
    const char* define;
    Format format;
    Content content;
    const char* description;
};

const Target targets[] = {
    {"view_depth", "OUT_VIEW_DEPTH", Format::R32F, content::viewDepth,
     "Distance along the view axis in scene units; 0 where nothing is"},
    {"normal", "OUT_NORMAL", Format::RGBA16F, content::normal,
     "Shading normal, unit, towards the eye, render space; w: how far off its face the point lies that the "
     "depth "
     "gives, scene units. 0 where nothing is"},
    // Rays are held above the face: half floats are off by what a grazing ray needs to meet its own triangle.
    {"face_normal", "OUT_FACE_NORMAL", Format::RGBA32F, content::normal,
     "Normal of the triangle, unit, towards the eye, render space; w: how far along it a ray has to start, "
     "scene "
     "units (shared/ray.h). 0 where nothing is"},
    {"position", "OUT_POSITION", Format::RGBA32F, content::position,
     "Render-space position; w is 1 where there is geometry"},
    {"albedo", "OUT_ALBEDO", Format::RGBA16F, content::colour,
     "Linear base colour; a is 1 where there is geometry"},
    // 8 bits of roughness would put 7.5 % on the peak of a highlight at 0.1.
    {"material", "OUT_MATERIAL", Format::RGBA16F, content::material,
     "Roughness, metallic, and in z whether the surface is unlit"},
    {"emission", "OUT_EMISSION", Format::RGBA16F, content::colour, "Linear emitted radiance"},
    {"refraction",
     "OUT_REFRACTION",
     Format::RG16F,
     {.channels = 2},
     "Share of the light that passes (KHR_materials_transmission), and the index of refraction behind the "
     "surface over that before it, as the eye sees it. 0 where nothing is"},
    {"motion", "OUT_MOTION", Format::RG32F, content::motion,
     "From this pixel to where its surface was in the last frame, in pixels"},
    {"coverage", "OUT_COVERAGE", Format::R8, {.channels = 1}, "1 where there is geometry, else 0"},
};

// Colour attachments that OpenGL 4.6 guarantees; further targets take a second step over the finished depth.
constexpr size_t maxTargets = 8;

void draw(Commands& commands, bool overFinishedDepth) {
    DrawState state;
    if (overFinishedDepth) {
        state.depth = Compare::Equal;
        state.depthWrite = false;
    }
    commands.drawScene(state, {TriangleClass::Opaque, TriangleClass::OpaqueDoubleSided, TriangleClass::Masked,
                               TriangleClass::MaskedDoubleSided});
}

Step rasterStep(std::string name, const SceneFacts& facts, Blended blended, bool overFinishedDepth) {
    return {.name = std::move(name),
            .run = [overFinishedDepth](Commands& commands) { draw(commands, overFinishedDepth); },
            .shaders = {"gbuffer/gbuffer.vert", "gbuffer/gbuffer.frag"},
            .defines = materialDefines(facts, blended)};
}

bool isConstantZero(const Target& target, const SceneFacts& facts) {
    const std::string_view port = target.port;
    return facts.triangles == 0 || (port == "emission" && !facts.hasEmission);
}

} // namespace

PassType GBuffer::type() {
    Describe<GBuffer> table(
        "GBuffer", "Rasterizes what the camera sees first: depth, normals, position, material, motion");
    table
        .output("depth", PortKind::Texture,
                "Reversed depth of the rasterizer: 1 at the near plane, 0 where nothing is")
        .carries(content::depth);
    for (const Target& target : targets)
        table.output(target.port, PortKind::Texture, target.description).carries(target.content);
    table.number("divisor", &GBuffer::divisor, 1, 16, "",
                 "Resolution per axis is that of the frame divided by this");
    table.number("guard", &GBuffer::guard, 0, 512, "pixels",
                 "Guard band: extra pixels of the frame on each side");
    table.flag("jitter", &GBuffer::jitter,
               "Moves the samples within the pixel from frame to frame (for temporal anti-aliasing)");
    table.choice(
        "blended", &GBuffer::blended, {"masked", "left_out"},
        "Blended materials: as masked ones by their cutoff, or not at all, where a pass behind draws "
        "them (TransparentComposite, WeightedBlended). Shadow maps and tracers have them masked "
        "either way");
    return table;
}

Declaration GBuffer::declare(const World& world, const Inputs&, const Demand& demand) const {
    Declaration declaration;
    const Extent extent = world.extentOf(view());
    const Blended drawn = blended == BlendedSurfaces::LeftOut ? Blended::LeftOut : Blended::Tested;
    std::vector<Step> steps = {rasterStep("rasterize", world.facts, drawn, false)};
    const bool empty = world.facts.triangles == 0;
    bool material = false;
    for (const Target& target : targets) {
        if (!demand.reads(target.port)) continue;
        Output output{.port = target.port, .desc = Desc::texture2D(target.format, extent, view())};
        if (isConstantZero(target, world.facts)) {
            output.constant = glm::vec4(0);
        } else {
            output.clear = glm::vec4(0);
            if (steps.back().uses.size() == maxTargets)
                steps.push_back(rasterStep("rasterize_rest", world.facts, drawn, true));
            steps.back().defines.emplace(target.define, "1");
            steps.back().uses.push_back({.port = target.port, .access = Access::Attachment, .write = true});
            material |= std::string_view(target.define) == "OUT_ALBEDO" ||
                        std::string_view(target.define) == "OUT_MATERIAL" ||
                        std::string_view(target.define) == "OUT_EMISSION" ||
                        std::string_view(target.define) == "OUT_REFRACTION";
        }
        declaration.outputs.push_back(std::move(output));
    }
    Output depth{.port = "depth", .desc = Desc::texture2D(Format::D32F, extent, view())};
    if (empty)
        depth.constant = glm::vec4(0);
    else
        depth.clear = glm::vec4(0);
    declaration.outputs.push_back(std::move(depth));
    if (empty) {
        declaration.leftOut.push_back({"rasterize", "the scene has no triangle"});
        return declaration;
    }
    for (Step& step : steps) {
        step.uses.push_back({.port = "depth", .access = Access::Attachment, .write = true});
        if (demand.reads("motion") && world.facts.geometryMoves) step.defines.emplace("MOVES", "1");
        declaration.steps.push_back(std::move(step));
    }

    if (!world.facts.hasMasked)
        declaration.leftOut.push_back({"alpha test", "no material is masked or blended"});
    if (drawn == Blended::LeftOut && world.facts.hasBlend)
        declaration.leftOut.push_back({"blended materials", "`blended` is left_out"});
    if (material && !world.facts.hasTextures)
        declaration.leftOut.push_back({"texture lookups", "no material has a texture"});
    if (demand.reads("emission") && !world.facts.hasEmission)
        declaration.leftOut.push_back({"emission", "no material emits light"});
    if (demand.reads("motion") && !world.facts.geometryMoves)
        declaration.leftOut.push_back(
            {"previous positions", "nothing in the scene moves; motion is the camera's alone"});

    declaration.depends = Causes::Camera | Causes::Cut | Causes::Geometry | Causes::Transforms |
                          Causes::Materials | Causes::Properties | Causes::Size;
    // Motion of a camera or an object that has just stopped is still that of the last frame: runs one frame
    // longer, which the executor does for readers of last frame's transforms.
    if (jitter) declaration.depends |= Causes::Frame;
    return declaration;
}

} // namespace kestrel
