// The members of glTF's objects that Kestrel relies on, as a table.
#pragma once
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace kestrel {

enum class GltfKind { Bool, String, Integer, Number, Index, IndexMap, Object };

struct GltfField;
using GltfShape = std::vector<GltfField>;

// One member of an object.
struct GltfField {
    std::string name;
    GltfKind kind = GltfKind::Number;
    bool isRequired = false;
    bool isArray = false;
    size_t length = 0; // of the array; 0: any
    double min = -std::numeric_limits<float>::max(), max = std::numeric_limits<float>::max();
    std::string target; // Index: the array at the top level that it refers to; empty: any number of 32 bits
    std::vector<std::string> choices; // String: the values that are allowed; empty: any
    const GltfShape* shape = nullptr; // Object

    GltfField required() && {
        isRequired = true;
        return std::move(*this);
    }
    GltfField array(size_t count = 0) && {
        isArray = true;
        length = count;
        return std::move(*this);
    }
};

// The shape of a whole document.
const GltfShape& gltfDocumentShape();

} // namespace kestrel
