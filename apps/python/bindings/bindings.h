// What the files of the Python module share. Each binds one topic; the public interface, in Python, is in
// kestrel/.
#pragma once
#include "graph/graph.h"
#include "image/image.h"
#include <cstddef>
#include <cstdint>
#include <memory>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <string>
#include <vector>

namespace kestrel::python {

namespace py = pybind11;

// A graph that Python edits. `revision` grows with every change, so that a renderer sees that there was one.
struct Document {
    Graph graph;
    std::uint64_t revision = 0;
};

// float32 of shape (height, width), or (height, width, channels) where there are 2 to 4; it owns the image's
// values, which are not copied.
py::array toArray(Image image);
// The same of bytes: uint8.
py::array toArray(std::vector<std::byte> bytes);
// A copy, as float32. uint8 is divided by 255, bool is 0 or 1. Throws InputError that begins with `what` for
// other whole numbers and other shapes.
Image toImage(const py::array& array, const std::string& what);

// As --set takes it in a sentence of its own: "pass.port". Throws InputError for another form.
PortRef portOf(const std::string& text);
// Throws InputError where a side is no number from 1 to 16384.
Extent extentOf(const std::vector<int>& size);

// A function of Python's that may be called from another thread, in its interpreter's lock. What it throws is
// kept, since it must not pass through C++ that is not ours.
class Callback {
public:
    explicit Callback(py::object function)
        : function_(std::move(function)) {}
    // False once it has thrown; it is not called again then.
    bool operator()(double fraction, const std::string& what);
    // Throws what it has thrown, if anything.
    void rethrow();
    // Whether this thread is in one: what it waits for would wait for it.
    static bool running();

private:
    py::object function_; // or None
    std::unique_ptr<py::error_already_set> thrown_;
};

void bindErrors(py::module_& module);
void bindGraph(py::module_& module);
void bindMetrics(py::module_& module);
void bindRenderer(py::module_& module);
void bindSweeps(py::module_& module);

} // namespace kestrel::python
