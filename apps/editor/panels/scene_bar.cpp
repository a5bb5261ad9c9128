#include "panels/scene_bar.h"
#include "edit/camera.h"
#include <fmt/format.h>
#include <imgui.h>

namespace kestrel::edit {

void SceneBar::show(Session& session, const std::function<void(const std::string&)>& say) {
    if (session.renderer() == nullptr) return;
    const auto& cameras = session.renderer()->scene().cameras;
    ImGui::PushItemWidth(ImGui::GetFontSize() * 9);
    if (ImGui::BeginCombo("##camera", ("camera " + session.cameraName()).c_str())) {
        for (const Camera& camera : cameras)
            if (ImGui::Selectable(camera.name.c_str(), camera.name == session.cameraName()))
                session.setCamera(camera.name);
        ImGui::EndCombo();
    }
    ImGui::PopItemWidth();
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("Drag the picture to turn about its middle, hold the right button and W A S D Q E "
                          "to fly, wheel to come nearer");
    ImGui::SameLine();
    if (ImGui::Button("graph's")) session.setCamera("");
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Back to the camera that the graph and its scene choose");
    ImGui::SameLine();
    if (ImGui::Button("copy")) copyCamera(session, say);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Puts the camera on the clipboard, as --camera takes it");
    if (session.duration() > 0) showTime(session);
}

void SceneBar::showTime(Session& session) {
    const bool runs = session.timeRuns();
    if (ImGui::Button(runs ? "pause###play" : "play###play")) {
        session.setTimeRuns(!runs);
        session.playing = true;
    }
    ImGui::SameLine();
    if (ImGui::Button("<")) step(session, -1);
    ImGui::SameLine();
    if (ImGui::Button(">")) step(session, 1);
    ImGui::SameLine();
    const float field = ImGui::GetFontSize() * 9;
    ImGui::PushItemWidth(-field - ImGui::GetStyle().ItemSpacing.x);
    auto time = static_cast<float>(session.time());
    if (ImGui::SliderFloat("##time", &time, 0, static_cast<float>(session.duration()), "%.3f s"))
        session.setTime(double(time));
    ImGui::PopItemWidth();
    ImGui::SameLine();
    ImGui::PushItemWidth(field);
    double milliseconds = session.timeStep() * 1000;
    const double least = 0, most = 1e6;
    if (ImGui::DragScalar("##step", ImGuiDataType_Double, &milliseconds, 0.1f, &least, &most, "step %.3f ms"))
        session.setTimeStep(milliseconds / 1000);
    ImGui::PopItemWidth();
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("Seconds of the scene from frame to frame, however long a frame takes");
}

void SceneBar::copyCamera(Session& session, const std::function<void(const std::string&)>& say) {
    const auto camera = session.movableCamera();
    if (!camera) return;
    const std::string text = "--camera '" + cameraOption(*camera) + "'";
    ImGui::SetClipboardText(text.c_str());
    say("copied: " + text);
}

void SceneBar::step(Session& session, int by) {
    session.setTimeRuns(false);
    session.setTime(session.time() + by * session.timeStep());
}

} // namespace kestrel::edit
