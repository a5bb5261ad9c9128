#include "scene/gltf_accessor.h"
#include "scene/gltf_views.h"
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <tiny_gltf.h>

namespace kestrel {
namespace {

size_t componentSize(int componentType) {
    switch (componentType) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return 4;
    default:
        return 0;
    }
}

const char* typeName(int components) {
    switch (components) {
    case 1:
        return "SCALAR";
    case 2:
        return "VEC2";
    case 3:
        return "VEC3";
    case 4:
        return "VEC4";
    default:
        return "MAT4";
    }
}

template<class T>
T loadAs(const std::byte* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

// glTF 2.0, 3.11: normalized integers stand for fractions of their largest value.
float toFloat(const std::byte* bytes, int componentType, bool normalized) {
    switch (componentType) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
        const float value = static_cast<float>(loadAs<std::int8_t>(bytes));
        return normalized ? std::max(value / 127.0f, -1.0f) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
        const float value = static_cast<float>(loadAs<std::uint8_t>(bytes));
        return normalized ? value / 255.0f : value;
    }
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
        const float value = static_cast<float>(loadAs<std::int16_t>(bytes));
        return normalized ? std::max(value / 32767.0f, -1.0f) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
        const float value = static_cast<float>(loadAs<std::uint16_t>(bytes));
        return normalized ? value / 65535.0f : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return static_cast<float>(loadAs<std::uint32_t>(bytes));
    default:
        return loadAs<float>(bytes);
    }
}

std::uint32_t toInteger(const std::byte* bytes, int componentType) {
    switch (componentType) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return loadAs<std::uint8_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return loadAs<std::uint16_t>(bytes);
    default:
        return loadAs<std::uint32_t>(bytes);
    }
}

bool isUnsigned(int componentType) {
    return componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
           componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

} // namespace

AccessorReader::AccessorReader(const GltfFile& file, const tinygltf::Model& model)
    : file_(file)
    , model_(model)
    , floats_(model.accessors.size())
    , integers_(model.accessors.size()) {}

AccessorReader::Form AccessorReader::formOf(int accessor) const {
    const tinygltf::Accessor& source = model_.accessors[static_cast<size_t>(accessor)];
    if (const auto found = replaced_.find(accessor); found != replaced_.end()) {
        const AccessorData& data = *found->second;
        int type = data.componentType;
        // The accessor says how the bits are meant.
        if (isUnsigned(source.componentType) && type == TINYGLTF_COMPONENT_TYPE_BYTE)
            type = TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
        if (isUnsigned(source.componentType) && type == TINYGLTF_COMPONENT_TYPE_SHORT)
            type = TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
        return {data.count, type, data.components, source.normalized};
    }
    return {source.count, source.componentType,
            tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(source.type)), source.normalized};
}

size_t AccessorReader::count(int accessor) const { return formOf(accessor).count; }
int AccessorReader::components(int accessor) const { return formOf(accessor).components; }

void AccessorReader::replace(int accessor, const AccessorData* data) {
    floats_[static_cast<size_t>(accessor)].reset();
    integers_[static_cast<size_t>(accessor)].reset();
    if (data == nullptr)
        replaced_.erase(accessor);
    else
        replaced_[accessor] = data;
}

void AccessorReader::spend(std::uint64_t bytes, const std::string& what) {
    if (bytes > bytesLeft())
        failGltf(file_, fmt::format("{} takes {} bytes; at most {} are decoded for one file", what, bytes,
                                    file_.limits.decodedBytes));
    decodedBytes_ += bytes;
}

const std::string* AccessorReader::unreadable(int accessor) const {
    const auto found = file_.unreadable.find(static_cast<size_t>(accessor));
    return found == file_.unreadable.end() ? nullptr : &found->second;
}

void AccessorReader::fail(int accessor, const std::string& what, const std::string& message) const {
    failGltf(file_, fmt::format("accessors[{}] ({}) {}", accessor, what, message));
}

AccessorReader::Layout AccessorReader::checkedView(int accessor, int bufferView, size_t byteOffset,
                                                   size_t elementSize, size_t count,
                                                   const std::string& what) const {
    const tinygltf::BufferView& view = model_.bufferViews[static_cast<size_t>(bufferView)];
    const std::span<const std::byte> bytes = gltfView(file_, static_cast<size_t>(bufferView));
    const size_t stride = view.byteStride == 0 ? elementSize : view.byteStride;
    if (stride < elementSize)
        fail(accessor, what, fmt::format("has elements of {} bytes in a stride of {}", elementSize, stride));
    // Without overflow: the last element must begin at least elementSize before the end.
    const size_t length = bytes.size();
    const bool begins = byteOffset <= length && elementSize <= length - byteOffset;
    if (!begins || count - 1 > (length - byteOffset - elementSize) / stride)
        fail(accessor, what,
             fmt::format(
                 "has {} elements of {} bytes from byte {} on, beyond bufferViews[{}], which has {} bytes",
                 count, elementSize, byteOffset, bufferView, length));
    return {bytes.data() + byteOffset, stride};
}

void AccessorReader::checkType(int accessor, int wanted, const std::string& what) const {
    if (components(accessor) != wanted) fail(accessor, what, fmt::format("is not {}", typeName(wanted)));
}

void AccessorReader::spendOn(int accessor, const std::string& what) {
    const std::uint64_t values = static_cast<std::uint64_t>(components(accessor));
    if (count(accessor) > bytesLeft() / (4 * values))
        fail(accessor, what,
             fmt::format("has {} elements; at most {} bytes are decoded for one file", count(accessor),
                         file_.limits.decodedBytes));
    decodedBytes_ += 4 * values * count(accessor);
}

template<class Out, class Convert>
std::vector<Out> AccessorReader::read(int accessor, int wanted, const std::string& what,
                                      const Convert& convert) {
    if (const std::string* reason = unreadable(accessor)) fail(accessor, what, *reason);
    checkType(accessor, wanted, what);
    const tinygltf::Accessor& source = model_.accessors[static_cast<size_t>(accessor)];
    const Form form = formOf(accessor);
    const size_t size = componentSize(form.componentType);
    if (size == 0) fail(accessor, what, fmt::format("has the component type {}", form.componentType));
    const size_t values = static_cast<size_t>(wanted);
    Layout layout;
    const auto replaced = replaced_.find(accessor);
    if (replaced != replaced_.end())
        layout = {replaced->second->bytes.data(), size * values};
    else if (source.bufferView >= 0)
        layout = checkedView(accessor, source.bufferView, source.byteOffset, size * values, form.count, what);
    spendOn(accessor, what);
    // Without a buffer view all elements are zero (glTF 2.0, 3.6.2.1).
    std::vector<Out> out(form.count * values, Out{0});
    for (size_t i = 0; layout.data != nullptr && i < form.count; ++i)
        for (size_t k = 0; k < values; ++k)
            out[i * values + k] = convert(layout.data + i * layout.stride + k * size, form);
    if (source.sparse.isSparse && replaced == replaced_.end())
        readSparse(accessor, wanted, what, convert, out);
    return out;
}

template<class Out, class Convert>
void AccessorReader::readSparse(int accessor, int wanted, const std::string& what, const Convert& convert,
                                std::vector<Out>& out) const {
    const tinygltf::Accessor& source = model_.accessors[static_cast<size_t>(accessor)];
    const Form form = formOf(accessor);
    const auto& sparse = source.sparse;
    const size_t size = componentSize(source.componentType), values = static_cast<size_t>(wanted);
    const size_t changed = static_cast<size_t>(sparse.count);
    if (changed > source.count)
        fail(accessor, what, fmt::format("is sparse with {} of {} elements", changed, source.count));
    if (!isUnsigned(sparse.indices.componentType))
        fail(accessor, what, "is sparse with indices that are not unsigned integers");
    const size_t indexSize = componentSize(sparse.indices.componentType);
    const Layout indices =
        checkedView(accessor, sparse.indices.bufferView, static_cast<size_t>(sparse.indices.byteOffset),
                    indexSize, changed, what);
    const Layout data =
        checkedView(accessor, sparse.values.bufferView, static_cast<size_t>(sparse.values.byteOffset),
                    size * values, changed, what);
    for (size_t i = 0; i < changed; ++i) {
        const size_t element = toInteger(indices.data + i * indices.stride, sparse.indices.componentType);
        if (element >= source.count)
            fail(accessor, what,
                 fmt::format("has the sparse index {}, but {} elements", element, source.count));
        for (size_t k = 0; k < values; ++k)
            out[element * values + k] = convert(data.data + i * data.stride + k * size, form);
    }
}

const std::vector<float>& AccessorReader::floats(int accessor, int wanted, const std::string& what) {
    std::optional<std::vector<float>>& kept = floats_[static_cast<size_t>(accessor)];
    if (kept) {
        checkType(accessor, wanted, what);
        return *kept;
    }
    kept = read<float>(accessor, wanted, what, [](const std::byte* bytes, const Form& form) {
        return toFloat(bytes, form.componentType, form.normalized);
    });
    for (size_t i = 0; i < kept->size(); ++i)
        if (!std::isfinite((*kept)[i]))
            fail(accessor, what,
                 fmt::format("is {} at element {}", std::isnan((*kept)[i]) ? "NaN" : "infinite",
                             i / static_cast<size_t>(wanted)));
    return *kept;
}

const std::vector<std::uint32_t>& AccessorReader::integers(int accessor, int wanted,
                                                           const std::string& what) {
    std::optional<std::vector<std::uint32_t>>& kept = integers_[static_cast<size_t>(accessor)];
    if (kept) {
        checkType(accessor, wanted, what);
        return *kept;
    }
    if (const std::string* reason = unreadable(accessor)) fail(accessor, what, *reason);
    if (!isUnsigned(formOf(accessor).componentType)) fail(accessor, what, "is not of unsigned integers");
    kept = read<std::uint32_t>(accessor, wanted, what, [](const std::byte* bytes, const Form& form) {
        return toInteger(bytes, form.componentType);
    });
    return *kept;
}

} // namespace kestrel
