// Reading accessors: bounds, types, sparse storage, normalized integers, NaN.
#pragma once
#include "scene/gltf_container.h"
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tinygltf {
class Model;
struct Accessor;
} // namespace tinygltf

namespace kestrel {

// Reads each accessor once and keeps it, so that what many primitives share is neither read nor counted
// twice. All functions take an index into the model's accessors and `what`, the user that messages name, and
// throw InputError for a wrong type, for data outside its buffer view, and beyond GltfLimits::decodedBytes in
// total.
class AccessorReader {
public:
    AccessorReader(const GltfFile& file, const tinygltf::Model& model);

    [[nodiscard]] size_t count(int accessor) const;
    [[nodiscard]] int components(int accessor) const; // 1, 2, 3, 4, 9 or 16

    // `components` floats an element: floats as they are (NaN and infinity are refused), normalized integers
    // as fractions, other integers as numbers.
    const std::vector<float>& floats(int accessor, int components, const std::string& what);
    // Unsigned integers of 8, 16 or 32 bits, `components` an element.
    const std::vector<std::uint32_t>& integers(int accessor, int components, const std::string& what);

private:
    // Where the elements lie; no bytes: all zero.
    struct Layout {
        const std::byte* data = nullptr;
        size_t stride = 0;
    };
    [[noreturn]] void fail(int accessor, const std::string& what, const std::string& message) const;
    Layout checkedView(int accessor, int bufferView, size_t byteOffset, size_t elementSize, size_t count,
                       const std::string& what) const;
    void checkType(int accessor, int components, const std::string& what) const;
    void spend(int accessor, const std::string& what);
    template<class Out, class Convert>
    std::vector<Out> read(int accessor, int components, const std::string& what, const Convert& convert);
    template<class Out, class Convert>
    void readSparse(int accessor, int components, const std::string& what, const Convert& convert,
                    std::vector<Out>& out) const;

    const GltfFile& file_;
    const tinygltf::Model& model_;
    std::vector<std::optional<std::vector<float>>> floats_;
    std::vector<std::optional<std::vector<std::uint32_t>>> integers_;
    std::uint64_t decodedBytes_ = 0;
};

} // namespace kestrel
