// Kestrel's errors as Python's: kestrel.InputError and its like, with every problem and its place.
#include "bindings.h"
#include "core/error.h"
#include <exception>
#include <fmt/format.h>
#include <utility>

namespace kestrel::python {

void bindErrors(py::module_&) {
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const Error& error) {
            py::list problems;
            for (const Problem& problem : error.problems())
                problems.append(py::make_tuple(problem.message, problem.where.file, problem.where.line,
                                               problem.where.column));
            const py::object made = py::module_::import("kestrel.errors")
                                        .attr("made")(static_cast<int>(error.status()), problems);
            PyErr_SetObject(py::type::handle_of(made).ptr(), made.ptr());
        }
    });
}

PortRef portOf(const std::string& text) {
    const auto port = parsePortRef(text);
    if (!port) throw InputError(fmt::format("'{}' is not of the form pass.port", text));
    return *port;
}

Extent extentOf(const std::vector<int>& size) {
    if (size.size() != 2 || size[0] < 1 || size[1] < 1 || size[0] > maxImageSide || size[1] > maxImageSide)
        throw InputError(fmt::format("size: it must be (width, height) with 1 to {} each", maxImageSide));
    return {static_cast<std::uint32_t>(size[0]), static_cast<std::uint32_t>(size[1]), 1};
}

namespace {

thread_local bool inCallback = false;

} // namespace

bool Callback::running() { return inCallback; }

bool Callback::operator()(double fraction, const std::string& what) {
    const py::gil_scoped_acquire lock;
    if (thrown_) return false;
    if (function_.is_none()) return true;
    inCallback = true;
    try {
        function_(fraction, what);
    } catch (const py::error_already_set& error) {
        thrown_ = std::make_unique<py::error_already_set>(error);
    }
    inCallback = false;
    return !thrown_;
}

void Callback::rethrow() {
    if (const auto thrown = std::move(thrown_)) throw py::error_already_set(*thrown);
}

} // namespace kestrel::python
