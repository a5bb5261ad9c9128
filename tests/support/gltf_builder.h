// Small glTF files made in tests, and a folder to put them in.
#pragma once
#include "core/error.h"
#include "core/files.h"
#include "scene/gltf_import.h"
#include "support/message.h"
#include "support/temporary_folder.h"
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace kestrel::test {

inline std::string base64(std::span<const unsigned char> bytes) {
    constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? bytes[i + k] : 0);
        for (size_t k = 0; k < 4; ++k)
            text += i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

enum ComponentType {
    Byte = 5120,
    UnsignedByte = 5121,
    Short = 5122,
    UnsignedShort = 5123,
    UnsignedInt = 5125,
    Float = 5126
};

// A document and its one buffer, which text() embeds.
class GltfBuilder {
public:
    nlohmann::json document = {{"asset", {{"version", "2.0"}}}};
    std::vector<unsigned char> data;

    template<class T>
    size_t view(const std::vector<T>& values) {
        data.resize((data.size() + 3) / 4 * 4);
        const size_t offset = data.size(), length = values.size() * sizeof(T);
        data.resize(offset + length);
        std::memcpy(data.data() + offset, values.data(), length);
        document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", length}});
        return document["bufferViews"].size() - 1;
    }

    // `values` in elements of `components`.
    template<class T>
    size_t accessor(const std::vector<T>& values, int components, ComponentType type,
                    bool normalized = false) {
        const char* name = components == 1   ? "SCALAR"
                           : components == 2 ? "VEC2"
                           : components == 3 ? "VEC3"
                           : components == 4 ? "VEC4"
                                             : "MAT4";
        nlohmann::json made = {{"bufferView", view(values)},
                               {"componentType", type},
                               {"count", values.size() / static_cast<size_t>(components)},
                               {"type", name}};
        if (normalized) made["normalized"] = true;
        document["accessors"].push_back(made);
        return document["accessors"].size() - 1;
    }
    size_t floats(const std::vector<float>& values, int components) {
        return accessor(values, components, Float);
    }

    // A mesh of one primitive under a node at the root of the scene.
    void addMeshNode(const nlohmann::json& primitive) {
        document["meshes"].push_back({{"primitives", {primitive}}});
        document["nodes"].push_back({{"mesh", document["meshes"].size() - 1}});
        document["scenes"][0]["nodes"].push_back(document["nodes"].size() - 1);
        document["scene"] = 0;
    }

    [[nodiscard]] std::string text() const {
        nlohmann::json whole = document;
        if (!data.empty() && !whole.contains("buffers"))
            whole["buffers"] = {{{"byteLength", data.size()},
                                 {"uri", "data:application/octet-stream;base64," + base64(data)}}};
        return whole.dump(1);
    }

    // Imported through a file in `folder`, without finishScene().
    [[nodiscard]] Scene import(const TemporaryFolder& folder) const {
        writeFile(folder / "test.gltf", text());
        return importGltf(folder / "test.gltf");
    }
};

// What importing the file says; "no error" where it loads.
inline std::string importMessage(const GltfBuilder& builder, const GltfLimits& limits = {}) {
    static const TemporaryFolder folder; // one for thousands of calls
    writeFile(folder / "test.gltf", builder.text());
    return messageOf([&] { (void)importGltf(folder / "test.gltf", {}, limits); });
}

// One triangle: accessors 0 (positions) and 1 (indices), mesh 0, node 0.
inline GltfBuilder triangleFile() {
    GltfBuilder builder;
    const size_t positions = builder.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
    const size_t indices = builder.accessor<std::uint16_t>({0, 1, 2}, 1, UnsignedShort);
    builder.addMeshNode({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
    return builder;
}

} // namespace kestrel::test
