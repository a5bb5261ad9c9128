#include "path_trace.h"
#include "draw/face_input.h"
#include "draw/material_defines.h"
#include "execute/commands.h"
#include "shared/work_list.h"
#include <cstddef>
#include <cstring>
#include <fmt/format.h>
#include <limits>
#include <span>

namespace kestrel {
namespace {

// Of shaders/ray_effects/path.glsl.
constexpr std::uint64_t recordBytes = 4 * 16, lightBytes = 2 * 16;
constexpr std::uint32_t tile = 8;

std::uint32_t tiles(std::uint32_t pixels) { return (pixels + tile - 1) / tile; }

// Paths have slots for whole tiles.
std::uint32_t groupsOf(const Extent& extent) { return tiles(extent.width) * tiles(extent.height); }

// From one list of slots to the next.
std::uint64_t aliveWords(const Extent& extent) {
    return sizeof(shared::WorkListHeader) / 4 + std::uint64_t{groupsOf(extent)} * tile * tile;
}

} // namespace

// What a declaration depends on.
struct PathTrace::Shape {
    Extent extent;
    View view;
    int bounces = 0;       // that are traced
    bool surfaces = false; // the tracer tells the surfaces of hits
    bool needs = false;    // the radiance asks for them
    bool adaptive = false, indirect = false;
};

PassType PathTrace::type() {
    Describe<PathTrace> table("PathTrace",
                              "Path tracing through any tracer, lit by any radiance: the mean over frames");
    return addSurface(table)
        .input("albedo", PortKind::Texture, "Their linear base colour")
        .carries(content::colour)
        .sameExtentAs("depth")
        .input("material", PortKind::Texture, "Their roughness, metallic, and in z whether they are unlit")
        .carries(content::material)
        .sameExtentAs("depth")
        .optionalInput("emission", PortKind::Texture, "The radiance that they send out of themselves")
        .carries(content::colour)
        .sameExtentAs("depth")
        .optionalInput("refraction", PortKind::Texture,
                       "Their transmission and relative index of refraction; without it they are opaque")
        .carries({.channels = 2})
        .sameExtentAs("depth")
        .input("tracer", PortKind::Tracer,
               "Who answers the closest-hit queries; where it tells positions only, paths end at their first "
               "hit")
        .input("radiance", PortKind::Radiance,
               "The light of the lights that surfaces send on, and what a ray that meets nothing brings; "
               "emission is counted from the surfaces themselves")
        .output("result", PortKind::Texture,
                "Mean radiance that reaches the camera, also from the surroundings where nothing is; alpha: "
                "paths a pixel")
        .carries(content::colour)
        .range(0, std::numeric_limits<double>::infinity())
        .output("indirect", PortKind::Texture,
                "The part of it that came along at least one ray of a path; alpha: paths a pixel")
        .carries(content::colour)
        .range(0, std::numeric_limits<double>::infinity())
        .internal("paths", PortKind::Buffer, "Where each path has come to (shaders/ray_effects/path.glsl)")
        .internal("alive", PortKind::Buffer, "The paths that go on after each bounce, list by list")
        .internal("light", PortKind::Buffer, "What each path has brought")
        .internal("pixels", PortKind::Buffer, "The pixels that are sampled, as a list (shared/work_list.h)")
        .internal("squares", PortKind::Texture, "Sum of squared differences of luminance from its mean")
        .internal("deviation", PortKind::Texture, "Standard deviation of a pixel's paths")
        .internal("sums", PortKind::Buffer, "Sums of it")
        .number("bounces", &PathTrace::bounces, 1, 8, "rays",
                "Rays of a path after the one that the G-buffer stands for")
        .number("samples", &PathTrace::samples, 1, 64, "paths",
                "Paths of a pixel that is sampled, in a frame")
        .flag("adaptive", &PathTrace::adaptive,
              "Samples pixels where their deviation asks for it, once they are warm; off: all alike")
        .number("share", &PathTrace::share, 0.01, 1, "",
                "Share of the pixels that a frame samples then, on the whole")
        .number("warm_up", &PathTrace::warmUp, 2, 1024, "frames", "Frames that sample every pixel first")
        .flag("area_lights", &PathTrace::areaLights,
              "The radiance has the light of rectangles and spheres in it, so that meshes which show them "
              "light mirrors and glass alone; off: they light along every ray");
}

PathTrace::Shape PathTrace::shapeOf(const World&, const Inputs& inputs, const Demand& demand) const {
    const Desc& depth = inputs["depth"].desc;
    Shape shape{.extent = depth.extent, .view = depth.view};
    shape.surfaces = (inputs["tracer"].desc.provides & provides::Surface) != 0;
    shape.needs = (inputs["radiance"].desc.required & required::Surface) != 0;
    shape.bounces = inputs["depth"].constant == glm::vec4(0) ? 0 : shape.surfaces ? bounces : 1;
    shape.adaptive = adaptive;
    shape.indirect = demand.reads("indirect");
    return shape;
}

Declaration PathTrace::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    const Shape shape = shapeOf(world, inputs, demand);
    const std::uint64_t slots = std::uint64_t{groupsOf(shape.extent)} * tile * tile;
    const auto limit = static_cast<std::uint64_t>(world.capabilities.maxStorageBlockBytes);
    if (slots * recordBytes > limit)
        declaration.problems.push_back(
            {"paths",
             fmt::format("paths of {} x {} pixels need {}; a storage block has at most {}",
                         shape.extent.width, shape.extent.height, bytesText(slots * recordBytes),
                         bytesText(limit)),
             true});
    const auto image = [&](const char* port, Format format, bool keeps) {
        declaration.outputs.push_back(
            {.port = port, .desc = Desc::texture2D(format, shape.extent, shape.view), .keeps = keeps});
    };
    image("result", Format::RGBA32F, true);
    if (shape.indirect) image("indirect", Format::RGBA32F, true);
    if (shape.bounces > 0) {
        declaration.outputs.push_back({.port = "paths", .desc = Desc::buffer(slots * recordBytes)});
        declaration.outputs.push_back(
            {.port = "alive",
             .desc = Desc::buffer(4 * aliveWords(shape.extent) * static_cast<std::uint64_t>(shape.bounces))});
    }
    declaration.outputs.push_back({.port = "light", .desc = Desc::buffer(slots * lightBytes)});
    if (shape.bounces == 0) declaration.leftOut.push_back({"tracing", "the depth is empty everywhere"});
    if (!shape.surfaces && bounces > 1)
        declaration.leftOut.push_back(
            {"bounces after the first", "the tracer tells no surface that a path could leave"});
    for (const auto& [port, what] :
         {std::pair{"emission", "emission of what is seen"}, {"refraction", "glass that is seen"}})
        if (!inputs.connected(port))
            declaration.leftOut.push_back({what, fmt::format("{} is not connected", port)});

    Step prepare{.name = "prepare", .run = &PathTrace::prepare};
    if (shape.adaptive) {
        image("squares", Format::R32F, true);
        image("deviation", Format::R32F, false);
        declaration.outputs.push_back(
            {.port = "sums", .desc = Desc::buffer(4 * (std::uint64_t{1} + groupsOf(shape.extent)))});
        declaration.outputs.push_back(
            {.port = "pixels",
             .desc = Desc::buffer(sizeof(shared::WorkListHeader) +
                                  4 * std::uint64_t{shape.extent.width} * shape.extent.height),
             .keeps = true});
        declaration.steps.push_back({.name = "report",
                                     .run = &PathTrace::report,
                                     .uses = {{.port = "pixels", .access = Access::Host}}});
        prepare.uses.push_back({.port = "pixels", .access = Access::Copy, .write = true});
    } else {
        declaration.leftOut.push_back({"choice of pixels", "every frame samples all of them"});
    }
    declaration.steps.push_back(std::move(prepare));
    if (shape.adaptive) declareChoice(shape, declaration);
    for (int path = 0; path < samples; ++path) declarePath(world, inputs, shape, path, declaration);
    declaration.depends = Causes::Frame | Causes::Properties;
    return declaration;
}

void PathTrace::declareChoice(const Shape& shape, Declaration& declaration) const {
    const Use sums{.port = "sums", .access = Access::Storage, .write = true};
    const auto read = [](const char* port) { return Use{.port = port, .access = Access::Image}; };
    const auto over = [extent = shape.extent](Commands& commands) { commands.dispatchOver(extent); };
    declaration.steps.push_back({.name = "measure",
                                 .run = over,
                                 .shaders = {"ray_effects/path_choose.comp"},
                                 .defines = {{"MEASURE", "1"}},
                                 .uses = {read("result"),
                                          read("squares"),
                                          {.port = "deviation", .access = Access::Image, .write = true},
                                          sums},
                                 .group = "choice"});
    declaration.steps.push_back({.name = "total",
                                 .run = &PathTrace::total,
                                 .shaders = {"ray_effects/path_choose.comp"},
                                 .defines = {{"TOTAL", "1"}},
                                 .uses = {sums},
                                 .group = "choice"});
    declaration.steps.push_back({.name = "choose",
                                 .run = &PathTrace::choose,
                                 .shaders = {"ray_effects/path_choose.comp"},
                                 .uses = {read("result"),
                                          read("deviation"),
                                          {.port = "sums", .access = Access::Storage},
                                          {.port = "pixels", .access = Access::Storage, .write = true}},
                                 .group = "choice"});
}

void PathTrace::declarePath(const World& world, const Inputs& inputs, const Shape& shape, int path,
                            Declaration& declaration) const {
    Defines defines = materialDefines(world.facts);
    defines.insert_or_assign("SAMPLES", std::to_string(samples));
    defines.insert_or_assign("ALIVE_WORDS", std::to_string(aliveWords(shape.extent)));
    if (shape.needs) defines.emplace("REQUIRES_SURFACE", "1");
    std::vector<Use> listed;
    if (shape.adaptive) {
        defines.emplace("LISTED", "1");
        listed = {{.port = "pixels", .access = Access::Storage},
                  {.port = "pixels", .access = Access::Indirect}};
    }
    const auto storage = [](const char* port) {
        return Use{.port = port, .access = Access::Storage, .write = true};
    };
    const auto with = [&](std::vector<Use> uses) {
        uses.insert(uses.end(), listed.begin(), listed.end());
        return uses;
    };

    if (shape.bounces > 0)
        declaration.steps.push_back({.name = fmt::format("clear{}", path),
                                     .run = {&PathTrace::clear, shape.bounces, 4 * aliveWords(shape.extent)},
                                     .uses = {{.port = "alive", .access = Access::Copy, .write = true}},
                                     .group = "tracing"});
    Step begin{.name = fmt::format("begin{}", path),
               .run = {&PathTrace::begin, path},
               .shaders = {"ray_effects/path_begin.comp"},
               .defines = defines,
               .uses = with({storage("light")}),
               .modules = {{"radiance", 0}},
               .group = "tracing"};
    for (const char* port : {"depth", "normal", "albedo", "material"})
        begin.uses.push_back({.port = port, .access = Access::Fetch});
    for (const auto& [port, define] : {std::pair{"emission", "EMISSION"}, {"refraction", "REFRACTION"}}) {
        if (!inputs.connected(port) || (inputs[port].constant == glm::vec4(0))) continue;
        begin.defines.emplace(define, "1");
        begin.uses.push_back({.port = port, .access = Access::Fetch});
    }
    if (shape.bounces == 0)
        begin.defines.emplace("LAST", "1");
    else
        begin.uses.insert(begin.uses.end(), {storage("paths"), storage("alive")});
    useFaceNormal(declaration, begin, inputs);
    declaration.steps.push_back(std::move(begin));

    for (int i = 1; i <= shape.bounces; ++i) {
        Step bounce{.name = fmt::format("bounce{}_{}", path, i),
                    .run = {&PathTrace::bounce, path, i, 4 * aliveWords(shape.extent)},
                    .shaders = {"ray_effects/path_bounce.comp"},
                    .defines = defines,
                    .uses = {storage("light"),
                             storage("paths"),
                             storage("alive"),
                             {.port = "alive", .access = Access::Indirect}},
                    .modules = {{"tracer", requests::ClosestHit | (shape.surfaces ? requests::Surface : 0)},
                                {"radiance", 0}},
                    .group = "tracing"};
        bounce.defines.emplace("TRACES", "1");
        if (shape.surfaces) bounce.defines.emplace("SURFACES", "1");
        if (i == shape.bounces) bounce.defines.emplace("LAST", "1");
        if (shape.surfaces && world.facts.hasUnlit) bounce.defines.emplace("UNLIT", "1");
        const bool panels = areaLights && world.facts.hasEmission &&
                            world.facts.rectangleLights + world.facts.sphereLights > 0;
        if (shape.surfaces && panels) bounce.defines.emplace("PANELS", "1");
        declaration.steps.push_back(std::move(bounce));
    }

    Step add{.name = fmt::format("add{}", path),
             .run = {&PathTrace::add, path},
             .shaders = {"ray_effects/path_add.comp"},
             .uses = with({{.port = "light", .access = Access::Storage},
                           {.port = "result", .access = Access::Image, .write = true}}),
             .group = "accumulation"};
    const auto keep = [&](const char* port, const char* define, bool kept) {
        if (!kept) return;
        add.defines.emplace(define, "1");
        add.uses.push_back({.port = port, .access = Access::Image, .write = true});
    };
    keep("indirect", "INDIRECT", shape.indirect);
    keep("squares", "SQUARES", shape.adaptive);
    if (shape.adaptive) add.defines.emplace("LISTED", "1");
    declaration.steps.push_back(std::move(add));
}

// Of the frames before this one: how many pixels were chosen is known to the GPU alone.
void PathTrace::report(Commands& commands) {
    if (any(commands.causes() & ~Causes::Frame)) frames_ = 0;
    if (frames_ == 0) {
        paths_ = 0;
        return;
    }
    const std::vector<std::byte> bytes = commands.download("pixels");
    shared::WorkListHeader header{};
    std::memcpy(&header, bytes.data(), sizeof(header));
    paths_ += static_cast<double>(header.count) * samples;
    commands.report("paths", paths_);
}

void PathTrace::prepare(Commands& commands) {
    if (any(commands.causes() & ~Causes::Frame)) frames_ = 0;
    ++frames_;
    if (commands.uses("pixels"))
        commands.uploadValue("pixels", shared::WorkListHeader{0, 0, 0, 0, {0, 1, 1, 0}});
}

void PathTrace::total(Commands& commands) const {
    commands.set("groups", groupsOf(commands.desc("result").extent));
    commands.dispatch(1);
}

void PathTrace::choose(Commands& commands) const {
    const auto cold = static_cast<std::uint32_t>(warmUp);
    const float wanted =
        frames_ <= cold ? 0 : static_cast<float>(cold) + share * static_cast<float>(frames_ - cold);
    commands.set("wanted", wanted * static_cast<float>(samples));
    commands.dispatchOver(commands.desc("result").extent);
}

void PathTrace::clear(Commands& commands, int lists, std::uint64_t stride) const {
    const shared::WorkListHeader empty{0, 0, 0, 0, {0, 1, 1, 0}};
    for (int i = 0; i < lists; ++i)
        commands.upload("alive", std::as_bytes(std::span(&empty, 1)), static_cast<std::uint64_t>(i) * stride);
}

void PathTrace::begin(Commands& commands, int path) const {
    commands.set("path", static_cast<std::uint32_t>(path));
    if (commands.uses("pixels"))
        commands.dispatchIndirect("pixels", offsetof(shared::WorkListHeader, groups));
    else
        commands.dispatchOver(commands.desc("depth").extent);
}

void PathTrace::bounce(Commands& commands, int path, int bounce, std::uint64_t stride) const {
    commands.set("path", static_cast<std::uint32_t>(path));
    commands.set("bounce", static_cast<std::uint32_t>(bounce));
    commands.dispatchIndirect("alive", static_cast<std::uint64_t>(bounce - 1) * stride +
                                           offsetof(shared::WorkListHeader, groups));
}

void PathTrace::add(Commands& commands, int path) const {
    commands.set("restart", std::uint32_t{frames_ == 1 && path == 0 ? 1u : 0u});
    if (commands.uses("pixels"))
        commands.dispatchIndirect("pixels", offsetof(shared::WorkListHeader, groups));
    else
        commands.dispatchOver(commands.desc("result").extent);
}

} // namespace kestrel
