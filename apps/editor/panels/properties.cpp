#include "panels/properties.h"
#include "edit/commands.h"
#include "edit/properties.h"
#include "graph/value_text.h"
#include "scene/builtin.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

namespace kestrel::edit {
namespace {

// A number's range as a slider where it is small, else as a field that is dragged. True if it changed.
bool numberWidget(const PropertyInfo& property, double& number) {
    const bool whole = property.kind == PropertyKind::Int;
    const bool bounded = std::isfinite(property.minimum) && std::isfinite(property.maximum);
    const double extent = property.maximum - property.minimum;
    const char* format = whole ? "%.0f" : "%.4g";
    // A slider for a range that spans few decades; wide ones are dragged by a share of the value.
    if (bounded && extent <= 100)
        return ImGui::SliderScalar("##value", ImGuiDataType_Double, &number, &property.minimum,
                                   &property.maximum, format);
    const double size = std::abs(number) > 0 ? std::abs(number) : 1;
    const auto speed = static_cast<float>(whole ? std::max(0.2, size * 0.01) : size * 0.01);
    return ImGui::DragScalar("##value", ImGuiDataType_Double, &number, speed,
                             bounded ? &property.minimum : nullptr, bounded ? &property.maximum : nullptr,
                             format);
}

double numberOf(const Value& value) {
    if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
    const auto* number = std::get_if<double>(&value);
    return number != nullptr ? *number : 0;
}

// The widget of a property; true with the new value in `value`.
bool widget(const PropertyInfo& property, Value& value) {
    switch (property.kind) {
    case PropertyKind::Bool: {
        bool flag = std::holds_alternative<bool>(value) && std::get<bool>(value);
        if (!ImGui::Checkbox("##value", &flag)) return false;
        value = flag;
        return true;
    }
    case PropertyKind::Int:
    case PropertyKind::Float: {
        double number = numberOf(value);
        if (!numberWidget(property, number)) return false;
        number = std::clamp(number, property.minimum, property.maximum);
        if (property.kind == PropertyKind::Int)
            value = static_cast<std::int64_t>(std::llround(number));
        else
            value = static_cast<double>(
                static_cast<float>(number)); // what a float holds, so that it is written short
        return true;
    }
    case PropertyKind::Choice: {
        const auto* held = std::get_if<std::string>(&value);
        if (!ImGui::BeginCombo("##value", held != nullptr ? held->c_str() : "")) return false;
        bool changed = false;
        for (const std::string& choice : property.choices)
            if (ImGui::Selectable(choice.c_str(), held != nullptr && choice == *held)) {
                value = choice;
                changed = true;
                break;
            }
        ImGui::EndCombo();
        return changed;
    }
    case PropertyKind::Text: {
        std::string text = std::holds_alternative<std::string>(value) ? std::get<std::string>(value) : "";
        if (!ImGui::InputText("##value", &text, ImGuiInputTextFlags_EnterReturnsTrue)) return false;
        value = text;
        return true;
    }
    case PropertyKind::Vector: {
        auto numbers = std::holds_alternative<std::vector<double>>(value)
                           ? std::get<std::vector<double>>(value)
                           : std::vector<double>();
        numbers.resize(static_cast<size_t>(property.components));
        std::vector<float> floats(numbers.begin(), numbers.end());
        if (!ImGui::DragScalarN("##value", ImGuiDataType_Float, floats.data(), property.components, 0.01f))
            return false;
        for (size_t i = 0; i < numbers.size(); ++i)
            numbers[i] = std::clamp(static_cast<double>(floats[i]), property.minimum, property.maximum);
        value = numbers;
        return true;
    }
    }
    return false;
}

} // namespace

void Properties::apply(Session& session, const std::string& name, const std::function<void(Graph&)>& change) {
    if (const std::string refused = session.apply(name, change, gesture_); !refused.empty()) say_(refused);
}

void Properties::show(Session& session, const std::string& pass,
                      const std::function<void(const std::string&)>& say) {
    say_ = say;
    const GraphPass* found = session.document.graph().find(pass);
    const PassType* type = found != nullptr ? session.registry().find(found->type) : nullptr;
    if (found != nullptr && type != nullptr)
        showPass(session, GraphPass(*found), *type); // a copy: commands change the document
    else
        showGraph(session);
    if (!ImGui::IsAnyItemActive()) ++gesture_;
    focus = false;
}

void Properties::showPass(Session& session, const GraphPass& pass, const PassType& type) {
    ImGui::TextUnformatted(fmt::format("{}: {}", pass.name, type.name).c_str());
    ImGui::PushTextWrapPos();
    ImGui::TextUnformatted(type.description.c_str());
    if (const std::string why = session.leftOut(pass.name); !why.empty())
        ImGui::TextUnformatted(("Left out: " + why).c_str());
    for (const Marked& marked : session.problems())
        if (marked.pass == pass.name)
            ImGui::TextColored({0.95f, 0.35f, 0.3f, 1}, "%s", marked.message.c_str());
    ImGui::PopTextWrapPos();
    bool muted = pass.muted;
    if (ImGui::Checkbox("muted", &muted))
        apply(session, muted ? "Mute" : "Unmute", [&](Graph& graph) { setMuted(graph, {pass.name}, muted); });
    ImGui::Separator();
    if (!ImGui::BeginTable("properties", 3, ImGuiTableFlags_SizingStretchProp)) return;
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthFixed);
    ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableSetupColumn("more", ImGuiTableColumnFlags_WidthFixed);
    for (const PropertyInfo& property : type.properties) showProperty(session, pass, property);
    ImGui::EndTable();
    std::string comment = pass.comment;
    if (ImGui::InputTextMultiline("comment", &comment, {0, ImGui::GetTextLineHeight() * 3}))
        apply(session, "Comment on " + pass.name,
              [&](Graph& graph) { setComment(graph, pass.name, comment); });
}

void Properties::showProperty(Session& session, const GraphPass& pass, const PropertyInfo& property) {
    ImGui::PushID(property.name.c_str());
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    const bool given = isGiven(pass, property.name);
    if (given)
        ImGui::TextUnformatted(property.name.c_str());
    else
        ImGui::TextDisabled("%s", property.name.c_str());
    if (ImGui::IsItemHovered()) {
        std::string range =
            std::isfinite(property.minimum)
                ? fmt::format("\n{} to {}", numberText(property.minimum), numberText(property.maximum))
                : "";
        ImGui::SetTooltip("%s%s %s\ndefault %s", property.description.c_str(), range.c_str(),
                          property.unit.c_str(), jsonText(property.defaultValue).c_str());
    }
    ImGui::TableNextColumn();
    ImGui::PushItemWidth(-ImGui::GetFontSize() * 6);
    if (focus && &property == &session.registry().find(pass.type)->properties.front()) {
        ImGui::SetWindowFocus(); // ImGui 1.90.1 gives the keyboard only within the window that has the focus
        ImGui::SetKeyboardFocusHere();
    }
    Value value = propertyValue(pass, property);
    const bool changed = widget(property, value);
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    middles[property.name] = {(low.x + high.x) / 2, (low.y + high.y) / 2};
    if (changed)
        apply(session, fmt::format("Set {}.{}", pass.name, property.name),
              [&](Graph& graph) { setProperty(graph, session.registry(), pass.name, property.name, value); });
    ImGui::PopItemWidth();
    ImGui::SameLine();
    ImGui::TextDisabled("%s", property.unit.c_str());
    ImGui::TableNextColumn();
    const auto follows = pass.bound.find(property.name);
    if (given && ImGui::SmallButton("default"))
        apply(session, fmt::format("Reset {}.{}", pass.name, property.name),
              [&](Graph& graph) { resetProperty(graph, pass.name, property.name); });
    if (given) ImGui::SameLine();
    if (ImGui::SmallButton(follows == pass.bound.end() ? "follow..." : ("= " + follows->second).c_str())) {
        variable_ = follows == pass.bound.end() ? property.name : follows->second;
        ImGui::OpenPopup("follow");
    }
    if (ImGui::BeginPopup("follow")) {
        ImGui::TextUnformatted("A variable of the graph, shared by what follows it:");
        const bool entered = ImGui::InputText("##variable", &variable_, ImGuiInputTextFlags_EnterReturnsTrue);
        for (const GraphVariable& variable : session.document.graph().variables)
            if (ImGui::Selectable(variable.name.c_str(), false, ImGuiSelectableFlags_DontClosePopups))
                variable_ = variable.name;
        if (ImGui::Button("Follow") || entered) {
            apply(session, fmt::format("{}.{} follows {}", pass.name, property.name, variable_),
                  [&](Graph& graph) {
                      followVariable(graph, session.registry(), pass.name, property.name, variable_);
                  });
            ImGui::CloseCurrentPopup();
        }
        if (follows != pass.bound.end()) {
            ImGui::SameLine();
            if (ImGui::Button("Leave it")) {
                apply(session, fmt::format("{}.{} has its own value", pass.name, property.name),
                      [&](Graph& graph) { leaveVariable(graph, pass.name, property.name); });
                ImGui::CloseCurrentPopup();
            }
        }
        ImGui::EndPopup();
    }
    ImGui::PopID();
}

// A variable is edited as the first property that follows it.
void Properties::showVariable(Session& session, const Graph& graph, const GraphVariable& variable) {
    for (const GraphPass& pass : graph.passes)
        for (const auto& [property, followed] : pass.bound) {
            const PassType* type = session.registry().find(pass.type);
            const PropertyInfo* info =
                type != nullptr && followed == variable.name ? type->property(property) : nullptr;
            if (info == nullptr) continue;
            Value value = variable.value;
            if (widget(*info, value))
                apply(session, "Set " + variable.name, [&](Graph& next) {
                    setProperty(next, session.registry(), pass.name, property, value);
                });
            return;
        }
    ImGui::TextDisabled("nothing follows it");
}

void Properties::showGraph(Session& session) {
    const Graph graph = session.document.graph();
    std::string name = graph.name;
    if (ImGui::InputText("name", &name))
        apply(session, "Name the graph", [&](Graph& next) { next.name = name; });
    std::string comment = graph.comment;
    if (ImGui::InputTextMultiline("comment", &comment, {0, ImGui::GetTextLineHeight() * 3}))
        apply(session, "Comment on the graph", [&](Graph& next) { next.comment = comment; });
    std::string scene = graph.sceneSource;
    if (ImGui::InputText("scene", &scene, ImGuiInputTextFlags_EnterReturnsTrue))
        apply(session, "Scene " + scene, [&](Graph& next) { next.sceneSource = scene; });
    if (ImGui::BeginCombo("built-in scenes", "")) {
        for (const std::string& each : builtinNames())
            if (ImGui::Selectable(each.c_str()))
                apply(session, "Scene " + each, [&](Graph& next) { next.sceneSource = "builtin:" + each; });
        ImGui::EndCombo();
    }
    ImGui::Separator();
    ImGui::TextUnformatted("Variables");
    for (const GraphVariable& variable : graph.variables) {
        ImGui::PushID(variable.name.c_str());
        showVariable(session, graph, variable);
        ImGui::SameLine();
        ImGui::TextUnformatted(variable.name.c_str());
        ImGui::SameLine();
        if (ImGui::SmallButton("remove"))
            apply(session, "Remove " + variable.name,
                  [&](Graph& next) { removeVariable(next, variable.name); });
        ImGui::PopID();
    }
    ImGui::Separator();
    ImGui::TextUnformatted("Outputs");
    for (const GraphOutput& output : graph.outputs) ImGui::BulletText("%s", output.port.text().c_str());
}

} // namespace kestrel::edit
