#include "edit/camera.h"
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>

namespace kestrel::edit {
namespace {

constexpr double steepest = 1.55; // radians, a degree from the pole

double distanceOf(const AddedCamera& camera) { return glm::length(*camera.target - *camera.eye); }

// A number with so many digits behind the point, as it will be read back.
double rounded(double value, int digits) {
    return std::strtod(fmt::format("{:.{}f}", value, digits).c_str(), nullptr) + 0.0;
}

// Digits behind the point that tell a hundred-thousandth of a length.
int digitsOf(double length) {
    return std::clamp(5 - static_cast<int>(std::floor(std::log10(std::max(length, 1e-12)))), 0, 17);
}

void finish(AddedCamera& camera) {
    const int digits = digitsOf(distanceOf(camera));
    for (auto* point : {&camera.eye, &camera.target})
        for (int i = 0; i < 3; ++i) (**point)[i] = rounded((**point)[i], digits);
    const double distance = distanceOf(camera);
    const double nearest = std::min(camera.nearPlane.value_or(distance), 0.01 * distance);
    camera.nearPlane = rounded(nearest, digitsOf(nearest));
}

// Azimuth about y and elevation of a direction, and back.
glm::dvec2 anglesOf(const glm::dvec3& direction) {
    return {std::atan2(direction.x, direction.z),
            std::atan2(direction.y, std::hypot(direction.x, direction.z))};
}
glm::dvec3 directionOf(const glm::dvec2& angles) {
    return {std::cos(angles.y) * std::sin(angles.x), std::sin(angles.y),
            std::cos(angles.y) * std::cos(angles.x)};
}
glm::dvec3 turned(const glm::dvec3& direction, double right, double up) {
    glm::dvec2 angles = anglesOf(direction);
    angles.x += right;
    angles.y = std::clamp(angles.y + up, -steepest, steepest);
    return glm::length(direction) * directionOf(angles);
}

std::string numbers(const glm::dvec3& point) { return fmt::format("{},{},{}", point.x, point.y, point.z); }

} // namespace

AddedCamera cameraFrom(const CameraState& state, const Scene& scene) {
    const glm::dmat4 view(state.view);
    const glm::dvec3 forward = -glm::dvec3(view[0][2], view[1][2], view[2][2]);
    AddedCamera camera;
    const glm::dvec3 position(state.position);
    // The origin of render space is the middle of the scene.
    const double closest = std::max(10 * double(state.nearPlane), 1e-9);
    const double distance = std::clamp(-glm::dot(position, forward), closest, 1000 * closest);
    camera.eye = position + scene.origin;
    camera.target = *camera.eye + distance * turned(forward, 0, 0);
    camera.fov = state.orthographic ? 45 : rounded(glm::degrees(double(state.verticalFov)), 4);
    camera.nearPlane = double(state.nearPlane);
    finish(camera);
    return camera;
}

CameraState stateOf(const AddedCamera& camera, const Scene& scene) {
    Scene alone;
    SceneSetup setup;
    setup.camera = camera;
    setUpScene(alone, setup, {});
    alone.origin = scene.origin;
    alone.rootTransform = scene.rootTransform;
    return cameraAt(alone, alone.camera, 0);
}

std::string cameraOption(const AddedCamera& camera) {
    return fmt::format("eye={} target={} fov={} near={}", numbers(*camera.eye), numbers(*camera.target),
                       *camera.fov, *camera.nearPlane);
}

void orbit(AddedCamera& camera, double right, double up) {
    camera.eye = *camera.target + turned(*camera.eye - *camera.target, right, up);
    finish(camera);
}

void lookAround(AddedCamera& camera, double right, double up) {
    // To the right is against the angle's sense, which is that of the way back.
    camera.target = *camera.eye + turned(*camera.target - *camera.eye, -right, up);
    finish(camera);
}

void dolly(AddedCamera& camera, double factor) {
    camera.eye = *camera.target + factor * (*camera.eye - *camera.target);
    finish(camera);
}

void fly(AddedCamera& camera, const glm::dvec3& by) {
    const glm::dvec3 way = *camera.target - *camera.eye, forward = glm::normalize(way);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0)));
    const glm::dvec3 move =
        glm::length(way) * (by.x * right + by.y * glm::cross(right, forward) + by.z * forward);
    camera.eye = *camera.eye + move;
    camera.target = *camera.target + move;
    finish(camera);
}

} // namespace kestrel::edit
