// Cameras and lights at one time.
#include "core/check.h"
#include "scene/animation.h"
#include "scene/geometry.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace kestrel {
namespace {

// A right-handed orthonormal frame: the axes of a node without scale, shear and mirroring.
struct Frame {
    glm::dvec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, position{0};
};

bool normalizeTo(glm::dvec3& out, const glm::dvec3& v) {
    const double length = std::sqrt(glm::dot(v, v));
    if (!(length > 0) || !std::isfinite(length)) return false;
    out = v / length;
    return true;
}

// z is kept in direction, then y; a node squeezed to nothing has the axes of the world.
Frame frameOf(const glm::dmat4& world) {
    Frame frame;
    frame.position = glm::dvec3(world[3]);
    glm::dvec3 z, y;
    if (!normalizeTo(z, glm::dvec3(world[2]))) return frame;
    glm::dvec3 up;
    if (!normalizeTo(up, glm::dvec3(world[1]))) return frame;
    if (!normalizeTo(y, up - glm::dot(up, z) * z)) return frame;
    frame.z = z;
    frame.y = y;
    frame.x = glm::cross(y, z);
    return frame;
}

Frame frameOfNode(const Scene& scene, const Pose& pose, int node) {
    return frameOf(node < 0 ? scene.rootTransform : pose.worlds[static_cast<size_t>(node)]);
}

// Between keys `a` and `b` at `s` of the way, with the slopes of the curve at both: a cubic Hermite curve,
// whose slopes are those of the parabola's chords (Catmull, Rom, "A Class of Local Interpolating Splines",
// 1974, for keys that are not evenly spaced). Straight where `smooth` is off.
template<class Value>
Value between(const std::vector<CameraKey>& path, size_t key, double s, bool smooth,
              Value CameraKey::*member) {
    const Value &a = path[key].*member, &b = path[key + 1].*member;
    if (!smooth) return a + s * (b - a);
    const auto slope = [&](size_t at) {
        const size_t from = at == 0 ? 0 : at - 1, to = std::min(at + 1, path.size() - 1);
        return (path[to].*member - path[from].*member) / (path[to].time - path[from].time);
    };
    const double interval = path[key + 1].time - path[key].time, s2 = s * s, s3 = s2 * s;
    return (2 * s3 - 3 * s2 + 1) * a + interval * (s3 - 2 * s2 + s) * slope(key) + (3 * s2 - 2 * s3) * b +
           interval * (s3 - s2) * slope(key + 1);
}

// Where a camera with a path is at one time; the first key holds before, the last after.
CameraKey keyAt(const Camera& camera, double time) {
    const std::vector<CameraKey>& path = camera.path;
    if (!(time > path.front().time)) return path.front();
    if (time >= path.back().time) return path.back();
    const auto after = std::upper_bound(path.begin(), path.end(), time,
                                        [](double t, const CameraKey& key) { return t < key.time; });
    const size_t key = static_cast<size_t>(after - path.begin()) - 1;
    const double s = (time - path[key].time) / (path[key + 1].time - path[key].time);
    CameraKey at{time};
    at.eye = between(path, key, s, camera.smooth, &CameraKey::eye);
    at.target = between(path, key, s, camera.smooth, &CameraKey::target);
    at.up = between(path, key, s, camera.smooth, &CameraKey::up);
    at.verticalFov = between(path, key, s, camera.smooth, &CameraKey::verticalFov);
    // A cubic curve may leave the values of its keys.
    at.verticalFov = std::clamp(at.verticalFov, 1e-4, 3.1415);
    return at;
}

// The frame of a key in the space `world`.
Frame frameOfKey(const CameraKey& key, const glm::dmat4& world) {
    glm::dvec3 z = key.eye - key.target, x = glm::cross(key.up, z);
    if (!normalizeTo(z, z)) z = glm::dvec3(0, 0, 1);
    // Where the path looks along its own up, any way up will do.
    if (!normalizeTo(x, x))
        x = glm::normalize(glm::cross(std::abs(z.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1), z));
    const glm::dmat4 local(glm::dvec4(x, 0), glm::dvec4(glm::cross(z, x), 0), glm::dvec4(z, 0),
                           glm::dvec4(key.eye, 1));
    return frameOf(world * local);
}

// The factor by which rootTransform scales lengths.
double rootScale(const Scene& scene) {
    const double determinant = std::abs(glm::determinant(glm::dmat3(scene.rootTransform)));
    return determinant == 1 ? 1 : std::cbrt(determinant);
}

} // namespace

CameraState cameraAt(const Scene& scene, int camera, double time) {
    KESTREL_CHECK_LE(0, camera);
    KESTREL_CHECK_LT(static_cast<size_t>(camera), scene.cameras.size());
    const Camera& source = scene.cameras[static_cast<size_t>(camera)];
    const Pose pose = poseAt(scene, time);
    Frame frame = frameOfNode(scene, pose, source.node);
    double verticalFov = double(source.verticalFov);
    if (!source.path.empty()) {
        const CameraKey key = keyAt(source, time);
        frame = frameOfKey(key, source.node < 0 ? scene.rootTransform
                                                : pose.worlds[static_cast<size_t>(source.node)]);
        verticalFov = key.verticalFov;
    }
    const glm::dvec3 position = frame.position - scene.origin;
    const float scale = static_cast<float>(rootScale(scene));

    CameraState state;
    state.position = glm::vec3(position);
    const glm::dvec3 axes[] = {frame.x, frame.y, frame.z};
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            state.view[column][row] = static_cast<float>(axes[row][column]);
        state.view[3][row] = static_cast<float>(-glm::dot(axes[row], position));
    }
    state.orthographic = source.orthographic;
    state.verticalFov = static_cast<float>(verticalFov);
    state.halfHeight = source.halfHeight * scale;
    state.aspect = source.aspect;
    state.nearPlane = source.nearPlane * scale;
    state.farPlane = source.farPlane * scale;
    return state;
}

glm::mat4 CameraState::projection(float frameAspect) const {
    const double ratio = double(frameAspect);
    // Pixels are square whatever frame the camera was made for; one that is narrower than that frame sees
    // more above and below, so that nothing is lost.
    const double taller = std::max(1.0, double(aspect) / ratio);
    const double n = double(nearPlane), f = double(farPlane);
    glm::dmat4 matrix(0);
    if (orthographic) {
        matrix[0][0] = 1 / (ratio * taller * double(halfHeight));
        matrix[1][1] = 1 / (taller * double(halfHeight));
        // depth = (f - distance) / (f - n), distance = -z
        matrix[2][2] = 1 / (f - n);
        matrix[3][2] = f / (f - n);
        matrix[3][3] = 1;
        return glm::mat4(matrix);
    }
    const double cotangent = 1 / (taller * std::tan(0.5 * double(verticalFov)));
    matrix[0][0] = cotangent / ratio;
    matrix[1][1] = cotangent;
    matrix[2][3] = -1;
    if (farPlane <= 0) { // infinite: depth = n / distance
        matrix[3][2] = n;
    } else { // depth = n (f - distance) / ((f - n) distance)
        matrix[2][2] = n / (f - n);
        matrix[3][2] = n * f / (f - n);
    }
    return glm::mat4(matrix);
}

std::vector<LightState> lightsAt(const Scene& scene, double time) {
    const Pose pose = poseAt(scene, time);
    const float scale = static_cast<float>(rootScale(scene));
    std::vector<LightState> states;
    states.reserve(scene.lights.size());
    for (const Light& light : scene.lights) {
        const Frame frame = frameOfNode(scene, pose, light.node);
        LightState state;
        state.kind = light.kind;
        state.position = glm::vec3(frame.position - scene.origin);
        state.direction = glm::vec3(-frame.z);
        state.tangent = glm::vec3(frame.x);
        state.bitangent = glm::vec3(frame.y);
        const bool candela = light.kind == LightKind::Point || light.kind == LightKind::Spot;
        state.intensity = light.colour * light.intensity * (candela ? scale * scale : 1.0f);
        state.range = light.range * scale;
        state.innerCone = light.innerCone;
        state.outerCone = light.outerCone;
        state.halfSize = light.halfSize * scale;
        states.push_back(state);
    }
    return states;
}

} // namespace kestrel
