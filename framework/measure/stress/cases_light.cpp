// Lights and materials at their ends, and closed rooms in which light is bounded.
#include "measure/stress/stress_case.h"
#include "shared/ggx.h"
#include <cmath>
#include <fmt/format.h>

namespace kestrel {
namespace {

// What a surface reflects: its albedo, and what a dielectric does besides, over the hemisphere the mean of
// Schlick's F0 + (1 - F0) (1 - cos)^5, which is F0 + (1 - F0) / 21.
double reflectanceOf(double albedo) {
    const double f0 = double{shared::dielectricReflectance}, mirrored = f0 + (1 - f0) / 21;
    return albedo + (1 - albedo) * mirrored;
}

} // namespace

void addLightCases(std::vector<StressCase>& cases) {
    const auto light = [&](const std::string& name, const std::string& does, SceneEdit edit) {
        cases.push_back(
            {.name = "light/" + name, .kind = StressKind::Light, .does = does, .edit = std::move(edit)});
    };
    light("none", "No light", {.dropLights = true});
    light("intensity_0", "Lights of intensity 0", {.intensity = 0});
    light("intensity_1e9", "Lights of a thousand million times the intensity", {.intensity = 1e9});
    light("kinds", "A light of every kind more",
          {.lights = {{.kind = LightKind::Point, .place = {0.5, 0.7, 0.5}},
                      {.kind = LightKind::Spot, .place = {-0.5, 0.9, 0.4}},
                      {.kind = LightKind::Directional, .place = {0.3, 1, 0.2}},
                      {.kind = LightKind::Rectangle, .place = {0, 0.9, -0.5}},
                      {.kind = LightKind::Sphere, .place = {0.6, 0.4, -0.6}}}});
    light("in_wall", "A point and a sphere inside a wall",
          {.lights = {{.kind = LightKind::Point, .where = EditLight::Where::InWall},
                      {.kind = LightKind::Sphere, .where = EditLight::Where::InWall}}});
    light("on_surface", "A point, a spot and a rectangle on a surface",
          {.lights = {{.kind = LightKind::Point, .where = EditLight::Where::OnSurface},
                      {.kind = LightKind::Spot, .where = EditLight::Where::OnSurface},
                      {.kind = LightKind::Rectangle, .where = EditLight::Where::OnSurface}}});
    light("far", "A point and a sphere a million radii away",
          {.lights = {{.kind = LightKind::Point, .place = {6e5, 8e5, 1e5}},
                      {.kind = LightKind::Sphere, .place = {-6e5, 8e5, 1e5}, .size = 1e4}}});
    light("tiny_area", "A rectangle and a sphere as wide as a millionth of the scene",
          {.lights = {{.kind = LightKind::Rectangle, .place = {0, 0.9, 0.1}, .size = 1e-6},
                      {.kind = LightKind::Sphere, .place = {0.2, 0.8, 0.3}, .size = 1e-6}}});
    light("in_camera", "A sphere so large that the eye is inside",
          {.lights = {{.kind = LightKind::Sphere, .place = {0, 3, 0}, .size = 20}}});
    for (const float roughness : {0.0f, 1.0f})
        for (const float metallic : {0.0f, 1.0f})
            light(fmt::format("roughness_{:g}_metallic_{:g}", roughness, metallic),
                  fmt::format("Roughness {:g}, metallic {:g} everywhere", roughness, metallic),
                  {.roughness = roughness, .metallic = metallic});
    light("albedo_0", "Black everywhere", {.albedo = glm::vec3(0)});
    light("albedo_1", "White everywhere", {.albedo = glm::vec3(1)});
    light("emission_1e6", "Every surface shines with radiance 1e6", {.emission = glm::vec3(1e6f)});
    light("half_overflow", "Every surface shines with more than a half float holds, in light as strong",
          {.emission = glm::vec3(3e5f, 1e5f, 7e4f), .intensity = 1e6});
    light("cutoff_0", "Every surface masked, and all of it there", {.alphaCutoff = 0.0f});
    light("cutoff_1", "Every surface masked at an alpha of 1", {.alphaCutoff = 1.0f});
    for (const double albedo : {0.0, 0.5, 0.9, 1.0})
        cases.push_back(
            {.name = fmt::format("light/furnace_{:g}", albedo),
             .kind = StressKind::Light,
             .does = fmt::format(
                 "A closed room that shines with radiance 1 and reflects {:g} of what arrives", albedo),
             .scene = "builtin:stress_furnace",
             .edit = {.albedo = glm::vec3(static_cast<float>(albedo)), .emission = glm::vec3(1)},
             .frames = 16,
             .expects = StressExpects::EnergyHeld,
             .reflectance = reflectanceOf(albedo)});
}

} // namespace kestrel
