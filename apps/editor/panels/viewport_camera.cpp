// The camera by mouse, over the picture.
#include "edit/camera.h"
#include "panels/viewport.h"
#include "ui/keys.h"
#include <algorithm>
#include <cmath>

namespace kestrel::edit {
namespace {

// What the held keys ask: right, up, forward.
glm::dvec3 wayOfKeys() {
    const auto held = [](char key) { return keyIsDown(key) ? 1.0 : 0.0; };
    return {held('D') - held('A'), held('E') - held('Q'), held('W') - held('S')};
}

} // namespace

void Viewport::moveCamera(Session& session, bool hovered, float height) {
    const ImGuiIO& io = ImGui::GetIO();
    std::optional<AddedCamera> camera;
    const auto moved = [&]() -> AddedCamera& {
        if (!camera) camera = session.movableCamera();
        return *camera;
    };
    if (session.renderer() == nullptr) return;
    if (hovered && ImGui::IsMouseClicked(ImGuiMouseButton_Right)) {
        flying_ = true;
        flown_ = false;
    }
    if (hovered && !onSlider_ && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) turning_ = true;
    turning_ = turning_ && ImGui::IsMouseDown(ImGuiMouseButton_Left);
    flying_ = flying_ && ImGui::IsMouseDown(ImGuiMouseButton_Right);
    const glm::dvec2 drag = glm::dvec2(io.MouseDelta.x, io.MouseDelta.y) / std::max(double(height), 1.0);
    const bool dragged = drag != glm::dvec2(0);
    if (turning_ && dragged) orbit(moved(), -3 * drag.x, 3 * drag.y);
    if (flying_) {
        flown_ = flown_ || dragged;
        if (dragged) lookAround(moved(), 2 * drag.x, -2 * drag.y);
        // Once across the distance to the target in a second, ten times as fast with Shift.
        if (const glm::dvec3 way = wayOfKeys(); way != glm::dvec3(0)) {
            flown_ = true;
            fly(moved(), way * std::min(double(io.DeltaTime), 0.1) * (io.KeyShift ? 10.0 : 1.0));
        }
    }
    if (hovered && io.MouseWheel != 0) dolly(moved(), std::pow(0.9, double(io.MouseWheel)));
    if (camera) session.setOwnCamera(*camera);
}

} // namespace kestrel::edit
