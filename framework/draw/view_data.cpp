#include "draw/view_data.h"
#include "core/check.h"
#include "core/error.h"
#include "draw/light_faces.h"
#include <fmt/format.h>
#include <numbers>

namespace kestrel {

static_assert(sizeof(FrameData) == 48 && offsetof(FrameData, sceneBounds) == 32);
static_assert(sizeof(ViewData) == 7 * 64 + 48 + 64 && offsetof(ViewData, position) == 7 * 64 &&
              offsetof(ViewData, jitter) == 7 * 64 + 32);

namespace {

// The `index`-th number of the van der Corput sequence of a base, in [0, 1).
double radicalInverse(std::uint32_t index, std::uint32_t base) {
    double result = 0;
    double digit = 1.0 / base;
    for (; index != 0; index /= base, digit /= base) result += digit * (index % base);
    return result;
}

// The frame's projection, narrowed or widened to what an image covers, in pixels of the frame from its lower
// left corner.
glm::dmat4 projectionOver(const CameraState& camera, const Extent& frame, const glm::dvec2& first,
                          const glm::dvec2& size) {
    const glm::dvec2 frameSize(frame.width, frame.height);
    const glm::dmat4 projection(camera.projection(static_cast<float>(frameSize.x / frameSize.y)));
    const glm::dvec2 scale = frameSize / size;
    const glm::dvec2 shift = (frameSize - 2.0 * first) / size - 1.0;
    // clip.xy' = scale * clip.xy + shift * clip.w
    glm::dmat4 window(1);
    window[0][0] = scale.x;
    window[1][1] = scale.y;
    window[3][0] = shift.x;
    window[3][1] = shift.y;
    return window * projection;
}

// What positionFromDepth() of lib/view.glsl needs.
void fillWays(ViewData& data, const glm::dmat4& inverseView, const glm::dmat4& inverseProjection,
              bool orthographic) {
    // The point of a pixel coordinate on a plane in front of the eye, as seen from there, over its depth.
    const auto way = [&](double x, double y) {
        const glm::dvec2 ndc = 2.0 * glm::dvec2(x, y) / glm::dvec2(data.size) - 1.0;
        const glm::dvec4 point = inverseProjection * glm::dvec4(ndc, 1, 1);
        const glm::dvec3 eye = glm::dvec3(point) / point.w;
        const glm::dvec3 seen = orthographic ? glm::dvec3(eye.x, eye.y, 0) : eye / -eye.z;
        return glm::dmat3(inverseView) * seen;
    };
    const glm::dvec3 corner = way(0, 0);
    const glm::dvec3 ahead = orthographic ? -glm::dvec3(inverseView[2]) : glm::dvec3(0);
    // eye.z and eye.w of (0, 0, depth, 1).
    data.corner = glm::vec4(corner, -inverseProjection[2][2]);
    data.rightward = glm::vec4(way(1, 0) - corner, -inverseProjection[3][2]);
    data.upward = glm::vec4(way(0, 1) - corner, inverseProjection[2][3]);
    data.ahead = glm::vec4(ahead, inverseProjection[3][3]);
}

CameraState cubeCamera(const CubeView& cube, const glm::vec3& eye) {
    // Ahead and up of each face; right is their cross product.
    constexpr glm::vec3 ahead[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    constexpr glm::vec3 above[] = {{0, 1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}, {0, 1, 0}, {0, 1, 0}};
    KESTREL_CHECK(cube.face >= 0 && cube.face < 6);
    const glm::vec3 forward = ahead[cube.face], up = above[cube.face];
    const glm::vec3 rows[] = {glm::cross(forward, up), up, -forward};
    CameraState camera;
    camera.position = cube.point.value_or(eye);
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) camera.view[column][row] = rows[row][column];
        camera.view[3][row] = -glm::dot(rows[row], camera.position);
    }
    camera.verticalFov = std::numbers::pi_v<float> / 2;
    camera.nearPlane = cube.nearPlane;
    camera.farPlane = cube.farPlane;
    return camera;
}

CameraState sceneCamera(const CameraView& view, const ViewMoment& moment) {
    KESTREL_CHECK(moment.scene != nullptr);
    const Scene& scene = *moment.scene;
    const int camera = view.name.empty() ? view.camera : cameraIndex(scene, view.name);
    if (camera < 0 || static_cast<std::size_t>(camera) >= scene.cameras.size())
        throw InputError(
            fmt::format("a view looks from camera {}; the scene has {}", camera, scene.cameras.size()));
    return cameraAt(scene, camera, moment.time);
}

CameraState lightCameraOf(const LightView& view, const ViewMoment& moment) {
    const std::size_t count = moment.lights == nullptr ? 0 : moment.lights->size();
    if (view.light < 0 || static_cast<std::size_t>(view.light) >= count)
        throw InputError(fmt::format("a view looks from light {}; the scene has {}", view.light, count));
    return lightCamera((*moment.lights)[static_cast<std::size_t>(view.light)], view.face, moment.bounds);
}

} // namespace

CameraState cameraOf(const View& view, const ViewMoment& moment) {
    if (const auto* of = std::get_if<CameraView>(&view.source)) return sceneCamera(*of, moment);
    if (const auto* of = std::get_if<CubeView>(&view.source)) return cubeCamera(*of, moment.camera.position);
    if (const auto* of = std::get_if<LightView>(&view.source)) return lightCameraOf(*of, moment);
    return moment.camera;
}

glm::vec2 jitterOf(std::uint32_t index) {
    const std::uint32_t point = index % jitterPeriod + 1;
    return {static_cast<float>(radicalInverse(point, 2) - 0.5),
            static_cast<float>(radicalInverse(point, 3) - 0.5)};
}

ViewData viewData(const View& view, const Extent& extent, const ViewFrame& frame) {
    KESTREL_CHECK(view.divisor >= 1 && view.guard >= 0);
    KESTREL_CHECK(extent.width >= 1 && extent.height >= 1 && frame.size.width >= 1 && frame.size.height >= 1);
    const Extent whole = sizeOf(view, frame.size);
    const int guard = view.guard / view.divisor;
    const glm::dvec2 first(-double(guard) * view.divisor);
    const glm::dvec2 size = glm::dvec2(extent.width, extent.height) * double(view.divisor);
    const glm::vec2 jitter = view.jitter ? jitterOf(frame.index) : glm::vec2(0);

    const glm::dmat4 eye(frame.camera.view);
    // A sample that stands jitter pixels right of the centre sees the image moved jitter pixels to the left.
    const glm::dmat4 projection =
        projectionOver(frame.camera, whole, first + glm::dvec2(jitter) * double(view.divisor), size);
    const glm::dmat4 before(frame.previousCamera.view);

    ViewData data{};
    data.view = frame.camera.view;
    data.projection = glm::mat4(projection);
    data.viewProjection = glm::mat4(projection * eye);
    data.inverseView = glm::mat4(glm::inverse(eye));
    data.inverseProjection = glm::mat4(glm::inverse(projection));
    data.inverseViewProjection = glm::mat4(glm::inverse(projection * eye));
    data.previousViewProjection =
        glm::mat4(projectionOver(frame.previousCamera, whole, first, size) * before);
    data.position = glm::vec4(frame.camera.position, frame.camera.orthographic ? 1 : 0);
    data.size = {extent.width, extent.height};
    data.guard = static_cast<std::uint32_t>(guard);
    data.divisor = static_cast<std::uint32_t>(view.divisor);
    data.jitter = jitter;
    data.nearPlane = frame.camera.nearPlane;
    data.farPlane = frame.camera.farPlane > 0 ? frame.camera.farPlane : 0;
    fillWays(data, glm::inverse(eye), glm::inverse(projection), frame.camera.orthographic);
    return data;
}

} // namespace kestrel
