// Reading accessors: bounds, types, sparse storage, normalized integers, NaN.
#pragma once
#include "scene/gltf_container.h"
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tinygltf {
class Model;
struct Accessor;
} // namespace tinygltf

namespace kestrel {

// Elements without gaps that take the place of an accessor's own.
struct AccessorData {
    std::vector<std::byte> bytes;
    size_t count = 0;
    int componentType = 0, components = 0;
};

// Reads each accessor once and keeps it, so that what many primitives share is neither read nor counted
// twice. All functions take an index into the model's accessors and `what`, the user that messages name, and
// throw InputError for a wrong type, for data outside its buffer view, and beyond GltfLimits::decodedBytes in
// total.
class AccessorReader {
public:
    AccessorReader(const GltfFile& file, const tinygltf::Model& model);

    [[nodiscard]] size_t count(int accessor) const;
    [[nodiscard]] int components(int accessor) const; // 1, 2, 3, 4, 9 or 16
    // Why the accessor cannot be read at all (GltfFile::unreadable); nullptr if it can. Reading it throws.
    [[nodiscard]] const std::string* unreadable(int accessor) const;

    // From now on `accessor` has these elements (nullptr: its own), until it gets others; what it gave before
    // is invalid. Whether they are normalized is still for the accessor to say. `data` must stay where it is.
    void replace(int accessor, const AccessorData* data);
    // Counts bytes that are decoded elsewhere towards GltfLimits::decodedBytes; throws beyond them.
    void spend(std::uint64_t bytes, const std::string& what);
    [[nodiscard]] std::uint64_t bytesLeft() const { return file_.limits.decodedBytes - decodedBytes_; }

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
    // What an accessor is, by itself or by what replaces it.
    struct Form {
        size_t count = 0;
        int componentType = 0, components = 0;
        bool normalized = false;
    };
    [[nodiscard]] Form formOf(int accessor) const;
    [[noreturn]] void fail(int accessor, const std::string& what, const std::string& message) const;
    Layout checkedView(int accessor, int bufferView, size_t byteOffset, size_t elementSize, size_t count,
                       const std::string& what) const;
    void checkType(int accessor, int components, const std::string& what) const;
    void spendOn(int accessor, const std::string& what);
    template<class Out, class Convert>
    std::vector<Out> read(int accessor, int components, const std::string& what, const Convert& convert);
    template<class Out, class Convert>
    void readSparse(int accessor, int components, const std::string& what, const Convert& convert,
                    std::vector<Out>& out) const;

    const GltfFile& file_;
    const tinygltf::Model& model_;
    std::vector<std::optional<std::vector<float>>> floats_;
    std::vector<std::optional<std::vector<std::uint32_t>>> integers_;
    std::map<int, const AccessorData*> replaced_;
    std::uint64_t decodedBytes_ = 0;
};

} // namespace kestrel
