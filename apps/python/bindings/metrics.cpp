// Errors between arrays, and pictures in files.
#include "bindings.h"
#include "core/error.h"
#include "image/colormap.h"
#include "image/error_figures.h"
#include "image/io.h"
#include <fmt/format.h>
#include <optional>
#include <pybind11/stl.h>

namespace kestrel::python {
namespace {

struct Measured {
    ErrorFigures figures;
    Image map;
};

Measured measured(const py::array& reference, const py::array& test, const std::optional<py::array>& mask,
                  bool hdr, std::optional<float> pixelsPerDegree) {
    if (pixelsPerDegree && !(*pixelsPerDegree > 0 && *pixelsPerDegree <= 1000))
        throw InputError(
            fmt::format("pixels_per_degree: it must be above 0 and at most 1000, not {}", *pixelsPerDegree));
    const Image first = toImage(reference, "reference"), second = toImage(test, "test");
    std::optional<Image> counted;
    if (mask) counted = toImage(*mask, "mask");
    ErrorOptions options{.hdr = hdr, .mask = counted ? &*counted : nullptr};
    if (pixelsPerDegree) options.pixelsPerDegree = *pixelsPerDegree;
    const py::gil_scoped_release unlocked;
    Measured result;
    result.figures = measureError(first, second, options, &result.map);
    return result;
}

void write(const std::string& file, const py::array& array, bool display) {
    const Image image = toImage(array, file);
    const bool colour = image.channels >= 3;
    const py::gil_scoped_release unlocked;
    writeImage(file, image, colour && !display ? Encoding::Srgb : Encoding::Linear);
}

} // namespace

void bindMetrics(py::module_& module) {
    using Mask = std::optional<py::array>;
    module.def("compare", [](const py::array& reference, const py::array& test, const Mask& mask, bool hdr,
                             std::optional<float> pixelsPerDegree) {
        return toJson(measured(reference, test, mask, hdr, pixelsPerDegree).figures);
    });
    module.def("flip", [](const py::array& reference, const py::array& test, bool hdr,
                          std::optional<float> pixelsPerDegree) {
        return toArray(measured(reference, test, {}, hdr, pixelsPerDegree).map);
    });
    module.def("heat_map", [](const py::array& errors) {
        return toArray(heatMap(convertChannels(toImage(errors, "errors"), 1)));
    });
    module.def("to_srgb",
               [](const py::array& linear) { return toArray(linearToSrgb(toImage(linear, "linear"))); });
    module.def("read_image", [](const std::string& file) { return toArray(readImage(file)); });
    module.def("write_image", &write);
}

} // namespace kestrel::python
