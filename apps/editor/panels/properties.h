// What one sets: properties of the selected pass, the graph's variables, its outputs.
#pragma once
#include "session.h"
#include <functional>
#include <map>
#include <string>

namespace kestrel::edit {

class Properties {
public:
    // Of one pass; empty: the graph's own (name, scene, variables, outputs).
    void show(Session& session, const std::string& pass, const std::function<void(const std::string&)>& say);
    bool focus = false; // the first widget takes the keyboard
    // Where the widget of a property was drawn last, its middle on the screen: for tests.
    std::map<std::string, glm::vec2> middles;

private:
    void showPass(Session& session, const GraphPass& pass, const PassType& type);
    void showProperty(Session& session, const GraphPass& pass, const PropertyInfo& property);
    void showGraph(Session& session);
    void showVariable(Session& session, const Graph& graph, const GraphVariable& variable);
    void apply(Session& session, const std::string& name, const std::function<void(Graph&)>& change);

    std::function<void(const std::string&)> say_;
    std::uint64_t gesture_ = 1; // goes up when a widget is let go: one step of undo a drag
    std::string variable_;      // typed for "follow a variable"
};

} // namespace kestrel::edit
