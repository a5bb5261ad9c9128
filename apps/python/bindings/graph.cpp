// The graph document, and the table of pass types.
#include "bindings.h"
#include "core/files.h"
#include "edit/commands.h"
#include "edit/lookup.h"
#include "edit/properties.h"
#include "graph/report.h"
#include "graph/value_text.h"
#include "named.h"
#include <algorithm>
#include <fmt/format.h>
#include <pybind11/stl.h>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace kestrel::python {
namespace {

// As numbers, texts and sequences come, numpy's too. Throws InputError for anything else.
Value valueOf(const py::handle& object, const std::string& name) {
    // NumPy 1 and 2 name theirs differently.
    const std::string_view type = Py_TYPE(object.ptr())->tp_name;
    if (py::isinstance<py::bool_>(object) || type == "numpy.bool_" || type == "numpy.bool")
        return py::bool_(py::reinterpret_borrow<py::object>(object)).cast<bool>();
    if (py::isinstance<py::str>(object)) return object.cast<std::string>();
    if (PySequence_Check(object.ptr()) != 0) {
        std::vector<double> numbers;
        for (const py::handle item : object) {
            numbers.push_back(PyFloat_AsDouble(item.ptr()));
            if (PyErr_Occurred() == nullptr) continue;
            PyErr_Clear();
            throw InputError(
                fmt::format("{}: must hold numbers, not {}", name, Py_TYPE(item.ptr())->tp_name));
        }
        return numbers;
    }
    if (PyIndex_Check(object.ptr()) != 0) {
        const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(object.ptr()));
        if (!whole) throw py::error_already_set();
        int beyond = 0;
        const long long number = PyLong_AsLongLongAndOverflow(whole.ptr(), &beyond);
        if (beyond != 0) throw InputError(fmt::format("{}: is out of range", name));
        return std::int64_t{number};
    }
    if (py::hasattr(object, "__float__")) return py::float_(py::reinterpret_borrow<py::object>(object));
    throw InputError(fmt::format("{}: must be a bool, a number, a text or a sequence of numbers, not {}",
                                 name, Py_TYPE(object.ptr())->tp_name));
}

// A number that is exactly a float becomes that of its shortest text, as in graph files: 0.1, not
// 0.10000000149.
py::float_ shortFloat(double number) { return py::float_(py::str(numberText(number))); }

py::object objectOf(const Value& value) {
    if (const auto* number = std::get_if<double>(&value)) return shortFloat(*number);
    if (const auto* numbers = std::get_if<std::vector<double>>(&value)) {
        py::tuple tuple(numbers->size());
        for (size_t i = 0; i < numbers->size(); ++i) tuple[i] = shortFloat((*numbers)[i]);
        return tuple;
    }
    return std::visit([](const auto& held) { return py::cast(held); }, value);
}

std::vector<std::string> passNames(const Graph& graph) {
    std::vector<std::string> names;
    for (const GraphPass& pass : graph.passes) names.push_back(pass.name);
    return names;
}

GraphPass& passOf(Document& document, const std::string& name) { return edit::passOf(document.graph, name); }

Document opened(const std::string& file) { return {loadGraph(graphFile(file))}; }

py::object propertyOf(Document& document, const std::string& pass, const std::string& property) {
    const GraphPass& held = passOf(document, pass);
    return objectOf(edit::propertyValue(held, edit::propertyOf(loadedRegistry(), held, property)));
}

void setProperty(Document& document, const std::string& pass, const std::string& property,
                 const py::object& value) {
    edit::setProperty(document.graph, loadedRegistry(), pass, property,
                      valueOf(value, pass + "." + property));
    ++document.revision;
}

// All or nothing.
void add(Document& document, const std::string& type, const std::string& name, const py::dict& properties) {
    Document changed = document;
    const std::string made = edit::addPass(changed.graph, loadedRegistry(), type, {});
    changed.graph.find(made)->position.reset();
    if (changed.graph.find(name) != nullptr && name != made)
        throw InputError(fmt::format("the graph has a pass '{}' already", name));
    edit::renamePass(changed.graph, made, name);
    std::vector<Problem> problems;
    for (const auto& [property, value] : properties) try {
            setProperty(changed, name, property.cast<std::string>(),
                        py::reinterpret_borrow<py::object>(value));
        } catch (const InputError& error) {
            problems.insert(problems.end(), error.problems().begin(), error.problems().end());
        }
    if (!problems.empty()) throw InputError(std::move(problems));
    document = std::move(changed);
}

std::vector<std::pair<std::string, std::string>> edgesOf(const Document& document) {
    std::vector<std::pair<std::string, std::string>> edges;
    for (const GraphEdge& edge : document.graph.edges) edges.emplace_back(edge.from.text(), edge.to.text());
    return edges;
}

std::vector<std::string> outputsOf(const Document& document) {
    std::vector<std::string> outputs;
    for (const GraphOutput& output : document.graph.outputs) outputs.push_back(output.port.text());
    return outputs;
}

void setOutputs(Document& document, const std::vector<std::string>& ports) {
    Graph changed = document.graph;
    changed.outputs.clear();
    for (const std::string& port : ports) edit::setOutput(changed, loadedRegistry(), portOf(port), true);
    document.graph = std::move(changed);
    ++document.revision;
}

py::dict variablesOf(const Document& document) {
    py::dict variables;
    for (const GraphVariable& variable : document.graph.variables)
        variables[py::str(variable.name)] = objectOf(variable.value);
    return variables;
}

void requireValid(const Document& document) {
    if (std::vector<Problem> problems = validate(document.graph, loadedRegistry()); !problems.empty())
        throw InputError(std::move(problems));
}

std::string typesJson() {
    std::vector<const PassType*> types;
    for (const PassType& type : loadedRegistry().types()) types.push_back(&type);
    return passesJson(types);
}

// A change through `edit`, which leaves the graph as it was where it throws.
template<class Edit>
auto changing(Edit edit) {
    return [edit](Document& document, const std::string& first, const std::string& second) {
        edit(document.graph, first, second);
        ++document.revision;
    };
}

} // namespace

void bindGraph(py::module_& module) {
    module.def("pass_types", &typesJson);
    py::class_<Document>(module, "Document")
        .def(py::init<>())
        .def_static("load", &opened)
        .def_static("parse", [](const std::string& text,
                                const std::string& file) { return Document{parseGraph(text, file)}; })
        .def("text", [](const Document& document) { return saveGraph(document.graph); })
        .def("save", [](const Document& document,
                        const std::string& file) { writeFile(file, saveGraph(document.graph)); })
        .def("copy", [](const Document& document) { return document; })
        .def("assign",
             [](Document& document, const Document& other) {
                 document.graph = other.graph;
                 ++document.revision;
             })
        .def("validate", &requireValid)
        .def_readonly("revision", &Document::revision)
        .def_property_readonly("file", [](const Document& document) { return document.graph.file.string(); })
        .def_property(
            "name", [](const Document& document) { return document.graph.name; },
            [](Document& document, const std::string& name) { document.graph.name = name; })
        .def_property(
            "comment", [](const Document& document) { return document.graph.comment; },
            [](Document& document, const std::string& comment) { document.graph.comment = comment; })
        .def_property(
            "scene", [](const Document& document) { return document.graph.sceneSource; },
            [](Document& document, const std::string& scene) { document.graph.sceneSource = scene; })
        .def_property("outputs", &outputsOf, &setOutputs)
        .def_property_readonly("edges", &edgesOf)
        .def_property_readonly("variables", &variablesOf)
        .def_property_readonly("pass_names",
                               [](const Document& document) { return passNames(document.graph); })
        .def("pass_type",
             [](Document& document, const std::string& pass) { return passOf(document, pass).type; })
        .def("muted",
             [](Document& document, const std::string& pass) { return passOf(document, pass).muted; })
        .def("mute",
             [](Document& document, const std::string& pass, bool muted) {
                 edit::setMuted(document.graph, {pass}, muted);
                 ++document.revision;
             })
        .def("get", &propertyOf)
        .def("set_property", &setProperty)
        .def("reset", changing([](Graph& graph, const std::string& pass, const std::string& property) {
                 edit::resetProperty(graph, pass, property);
             }))
        .def("add", &add)
        .def("remove",
             [](Document& document, const std::string& pass) {
                 edit::removePasses(document.graph, loadedRegistry(), {pass}, false);
                 ++document.revision;
             })
        .def("rename", changing(&edit::renamePass))
        .def("connect", changing([](Graph& graph, const std::string& from, const std::string& to) {
                 edit::connect(graph, loadedRegistry(), portOf(from), portOf(to));
             }))
        .def("disconnect",
             [](Document& document, const std::string& to) {
                 edit::disconnect(document.graph, {portOf(to)});
                 ++document.revision;
             })
        .def("set", [](Document& document, const std::string& setting) {
            applySetting(document.graph, loadedRegistry(), setting);
            ++document.revision;
        });
}

} // namespace kestrel::python
