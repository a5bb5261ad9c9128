// Values of properties and the variables that they follow.
#pragma once
#include "graph/graph.h"
#include <string>

namespace kestrel::edit {

// What a property is: what the document gives, else the table's default.
Value propertyValue(const GraphPass& pass, const PropertyInfo& property);
// Whether the document gives it.
bool isGiven(const GraphPass& pass, const std::string& property);

// Gives a property a value, which must be one of its table. One that follows a variable sets the variable,
// with all that follow it; refused where one of them cannot have the value.
void setProperty(Graph& graph, const Registry& registry, const std::string& pass, const std::string& property,
                 const Value& value);
// As in the table: the document gives nothing, and no variable is followed.
void resetProperty(Graph& graph, const std::string& pass, const std::string& property);

// The property follows a variable from now on: a new one with its present value, or one that is there and
// whose value it can have.
void followVariable(Graph& graph, const Registry& registry, const std::string& pass,
                    const std::string& property, const std::string& variable);
// It keeps the value, as its own.
void leaveVariable(Graph& graph, const std::string& pass, const std::string& property);
void renameVariable(Graph& graph, const std::string& from, const std::string& to);
// What follows it keeps its value.
void removeVariable(Graph& graph, const std::string& variable);

} // namespace kestrel::edit
