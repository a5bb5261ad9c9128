// Images and bytes as numpy arrays, and back.
#include "bindings.h"
#include "core/error.h"
#include <cstring>
#include <fmt/format.h>
#include <memory>

namespace kestrel::python {
namespace {

// An array that keeps `held` alive, in whose memory it lies.
template<class Element, class Held>
py::array owning(std::unique_ptr<Held> held, const std::vector<py::ssize_t>& shape, const Element* data) {
    const py::capsule owner(held.get(), [](void* memory) { delete static_cast<Held*>(memory); });
    static_cast<void>(held.release());
    return py::array_t<Element>(shape, data, owner);
}

} // namespace

py::array toArray(Image image) {
    std::vector<py::ssize_t> shape{image.height, image.width};
    if (image.channels > 1) shape.push_back(image.channels);
    auto values = std::make_unique<std::vector<float>>(std::move(image.values));
    const float* data = values->data();
    return owning<float>(std::move(values), shape, data);
}

py::array toArray(std::vector<std::byte> bytes) {
    auto held = std::make_unique<std::vector<std::byte>>(std::move(bytes));
    const auto* data = reinterpret_cast<const std::uint8_t*>(held->data());
    const auto size = static_cast<py::ssize_t>(held->size());
    return owning<std::uint8_t>(std::move(held), {size}, data);
}

Image toImage(const py::array& array, const std::string& what) {
    const py::ssize_t channels = array.ndim() == 3 ? array.shape(2) : 1;
    if ((array.ndim() != 2 && array.ndim() != 3) || channels < 1 || channels > 4) {
        std::string shape;
        for (py::ssize_t i = 0; i < array.ndim(); ++i)
            shape += (i == 0 ? "" : ", ") + std::to_string(array.shape(i));
        throw InputError(
            fmt::format("{}: its shape must be (height, width) or (height, width, 1 to 4 channels), not ({})",
                        what, shape));
    }
    if (array.shape(0) < 1 || array.shape(1) < 1 || array.shape(0) > maxImageSide ||
        array.shape(1) > maxImageSide)
        throw InputError(fmt::format("{}: its sides must be 1 to {}", what, maxImageSide));
    const char kind = array.dtype().kind();
    const bool bytes = kind == 'u' && array.dtype().itemsize() == 1;
    if (kind != 'f' && kind != 'b' && !bytes)
        throw InputError(fmt::format("{}: its values must be floats, uint8 or bool, not {}", what,
                                     std::string(py::str(array.dtype()))));
    const auto floats = py::array_t<float, py::array::c_style | py::array::forcecast>::ensure(array);
    if (!floats) throw py::error_already_set();
    Image image(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)),
                static_cast<int>(channels));
    std::memcpy(image.values.data(), floats.data(), image.values.size() * sizeof(float));
    if (bytes)
        for (float& value : image.values) value /= 255;
    return image;
}

} // namespace kestrel::python
