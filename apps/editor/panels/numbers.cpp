#include "panels/numbers.h"
#include "graph/report.h"
#include <algorithm>
#include <fmt/format.h>
#include <imgui.h>
#include <optional>
#include <set>

namespace kestrel::edit {
namespace {

void push(std::vector<float>& series, float value, size_t kept) {
    if (series.size() >= kept) series.erase(series.begin());
    series.push_back(value);
}

} // namespace

void Numbers::add(const Session& session) {
    if (session.renderer() == nullptr || session.frames() == frame_) return;
    frame_ = session.frames();
    const FrameRecord& record = session.renderer()->last();
    std::map<std::string, double> passes;
    for (const PlanPass& pass : session.renderer()->plan().passes) passes[pass.name] = 0;
    for (const StepSample& sample : record.samples)
        if (!sample.preview) passes[sample.pass] += sample.ms;
    std::erase_if(history_,
                  [&](const auto& item) { return !item.first.empty() && !passes.contains(item.first); });
    for (const auto& [pass, ms] : passes) push(history_[pass], static_cast<float>(ms), kept);
    push(history_[""], static_cast<float>(record.ms), kept);
}

void Numbers::showTimes(const Session& session) {
    const Renderer* renderer = session.renderer();
    if (renderer == nullptr || session.frames() == 0) return;
    const Profile& profile = session.profile();
    const Spread frame = profile.frame();
    ImGui::TextUnformatted(
        fmt::format("frame {}: {:.2f} ms, median of {} {:.2f} ms; previews {:.2f} ms; clock: {}",
                    renderer->last().index, renderer->last().ms, profile.frameCount(), frame.median,
                    profile.previews().median, renderer->options().timing ? "each step" : "frame")
            .c_str());
    const std::vector<float>& frames = history_[""];
    ImGui::PlotLines("##frame", frames.data(), static_cast<int>(frames.size()), 0, "frame, ms", 0, 3.4e38f,
                     {ImGui::GetContentRegionAvail().x, ImGui::GetTextLineHeight() * 3});
    if (!ImGui::BeginTable("times", 5,
                           ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV | ImGuiTableFlags_Resizable))
        return;
    for (const char* title : {"pass", "last, ms", "median, ms", "ran in", "history"})
        ImGui::TableSetupColumn(title);
    ImGui::TableHeadersRow();
    std::set<std::string> ran;
    for (const StepSample& sample : renderer->last().samples) ran.insert(sample.pass);
    for (const Profile::PassTime& pass : profile.passes()) {
        const std::vector<float>& series = history_[pass.name];
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(pass.name.c_str());
        ImGui::TableNextColumn();
        if (ran.contains(pass.name))
            ImGui::Text("%.3f", series.empty() ? 0.0 : static_cast<double>(series.back()));
        else
            ImGui::TextDisabled("not run");
        ImGui::TableNextColumn();
        ImGui::Text("%.3f", pass.ms.median);
        ImGui::TableNextColumn();
        ImGui::Text("%d of %d", pass.runs, profile.frameCount());
        ImGui::TableNextColumn();
        ImGui::PlotLines(("##" + pass.name).c_str(), series.data(), static_cast<int>(series.size()), 0,
                         nullptr, 0, 3.4e38f, {ImGui::GetContentRegionAvail().x, ImGui::GetTextLineHeight()});
    }
    ImGui::EndTable();
    for (const auto& [pass, values] : renderer->last().values)
        for (const auto& [key, value] : values) ImGui::Text("%s: %s = %g", pass.c_str(), key.c_str(), value);
}

// Resources as bars over the steps of the frame; those that share an object stand in one row.
void Numbers::showResources(const Session& session, const std::function<void(const PortRef&)>& apart) {
    const Renderer* renderer = session.renderer();
    if (renderer == nullptr) return;
    const Plan& plan = renderer->plan();
    ImGui::TextUnformatted(memoryText(plan.memory).c_str());
    if (plan.previews.memory > 0) ImGui::Text("previews: %s more", bytesText(plan.previews.memory).c_str());
    const float row = ImGui::GetTextLineHeightWithSpacing(), names = ImGui::GetFontSize() * 12;
    const float width = std::max(ImGui::GetContentRegionAvail().x - names, 50.0f);
    const auto steps = static_cast<float>(std::max<size_t>(plan.steps.size(), 1));
    ImGui::TextDisabled("a click gives a resource memory of its own, and says whether the picture changed");
    ImDrawList* list = ImGui::GetWindowDrawList();
    std::optional<PortRef> chosen;
    for (size_t object = 0; object < plan.objects.size(); ++object) {
        const ImVec2 corner = ImGui::GetCursorScreenPos();
        ImGui::InvisibleButton(fmt::format("##object{}", object).c_str(), {names + width, row});
        const bool hovered = ImGui::IsItemHovered(), clicked = ImGui::IsItemClicked();
        const float pointer = ImGui::GetIO().MousePos.x;
        const std::string size = bytesText(plan.objects[object].desc.totalBytes());
        list->AddText(corner, ImGui::GetColorU32(ImGuiCol_Text), size.c_str());
        std::string tip = describe(plan.objects[object].desc);
        for (size_t i = 0; i < plan.resources.size(); ++i) {
            const PlanResource& resource = plan.resources[i];
            if (resource.object != static_cast<int>(object)) continue;
            const float from = resource.transient ? static_cast<float>(resource.firstStep) : 0;
            const float to = resource.transient ? static_cast<float>(resource.lastStep + 1) : steps;
            const ImVec2 low(corner.x + names + width * from / steps, corner.y + 1);
            const ImVec2 high(corner.x + names + width * to / steps - 1, corner.y + row - 2);
            const auto hue = static_cast<float>(i) * 0.381966f;
            const ImU32 colour = ImColor::HSV(hue - std::floor(hue), 0.5f, resource.transient ? 0.7f : 0.5f);
            list->AddRectFilled(low, high, colour, 2);
            list->PushClipRect(low, high, true);
            list->AddText({low.x + 3, low.y}, IM_COL32_WHITE, resource.port.text().c_str());
            list->PopClipRect();
            const auto& alone = session.apart;
            if (std::find(alone.begin(), alone.end(), resource.port) != alone.end())
                list->AddRect(low, high, IM_COL32(255, 170, 50, 255), 2, 0, 2);
            if (clicked && pointer >= low.x && pointer <= high.x) chosen = resource.port;
            tip += fmt::format("\n{}: {}, {}", resource.port.text(), bytesText(resource.desc.totalBytes()),
                               !resource.transient ? resource.history ? "with last frame's" : "stays"
                               : resource.firstStep == resource.lastStep
                                   ? fmt::format("step {}", resource.firstStep)
                                   : fmt::format("steps {} to {}", resource.firstStep, resource.lastStep));
        }
        if (hovered) ImGui::SetTooltip("%s", tip.c_str());
    }
    if (chosen) apart(*chosen); // compiles anew: the plan is another then
}

void Numbers::showLeftOut(const Session& session, const std::function<void(const std::string&)>& goTo) {
    if (session.renderer() == nullptr) return;
    for (const LeftOut& item : session.renderer()->plan().leftOut) {
        const std::string text = item.what + ": " + item.why;
        if (ImGui::Selectable(text.c_str())) goTo(item.what.substr(0, item.what.find_first_of(".:")));
    }
}

} // namespace kestrel::edit
