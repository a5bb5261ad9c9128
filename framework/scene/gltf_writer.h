// The JSON and the binary chunk of a .glb file while it is written.
#pragma once
#include "scene/scene.h"
#include <cstddef>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace kestrel {

using OrderedJson = nlohmann::ordered_json;

// A list of numbers from a glm vector or matrix column order, floats widened exactly.
template<class Vector>
OrderedJson jsonNumbers(const Vector& values, int count) {
    OrderedJson list = OrderedJson::array();
    for (int i = 0; i < count; ++i) list.push_back(double(values[i]));
    return list;
}

class GltfWriter {
public:
    OrderedJson document = {{"asset", {{"version", "2.0"}, {"generator", "Kestrel"}}}};

    // Appends bytes to the binary chunk; the index of a buffer view of them.
    size_t addView(std::span<const std::byte> bytes);

    // Appends elements of `components` values of type T; the index of the accessor. `type` is glTF's name of
    // the element type, `componentType` its number for T. With `bounds`, minimum and maximum are stated.
    template<class T>
    size_t addAccessor(const T* values, size_t count, int components, const char* type, int componentType,
                       bool bounds = false) {
        const size_t length = count * static_cast<size_t>(components);
        OrderedJson accessor = {{"bufferView", addView(std::as_bytes(std::span(values, length)))},
                                {"componentType", componentType},
                                {"count", count},
                                {"type", type}};
        if (bounds) addBounds(accessor, values, count, components);
        return append("accessors", std::move(accessor));
    }
    // Floats: 5126.
    size_t addFloats(const float* values, size_t count, int components, bool bounds = false);

    // Appends to an array at the top level of the document; the index there.
    size_t append(const char* array, OrderedJson element);
    // Lists the extension in extensionsUsed.
    void use(const char* extension);

    // The whole file. Throws InputError above 4 GiB, which the format cannot state.
    [[nodiscard]] std::vector<std::byte> finish();

private:
    template<class T>
    static void addBounds(OrderedJson& accessor, const T* values, size_t count, int components) {
        for (const bool isMin : {true, false}) {
            OrderedJson bound = OrderedJson::array();
            for (int k = 0; k < components; ++k) {
                T best = values[k];
                for (size_t i = 0; i < count; ++i) {
                    const T value = values[i * static_cast<size_t>(components) + static_cast<size_t>(k)];
                    if (isMin ? value < best : value > best) best = value;
                }
                bound.push_back(double(best));
            }
            accessor[isMin ? "min" : "max"] = std::move(bound);
        }
    }

    std::vector<std::byte> binary_;
};

// Materials with the textures, samplers and images that they use.
void writeGltfMaterials(GltfWriter& writer, const Scene& scene);
// Meshes; for each of the scene's the index in the file, or -1 where it has no triangles.
std::vector<int> writeGltfMeshes(GltfWriter& writer, const Scene& scene);
// Nodes, cameras, lights, skins, and the scene.
void writeGltfNodes(GltfWriter& writer, const Scene& scene, const std::vector<int>& meshIndex);
void writeGltfAnimations(GltfWriter& writer, const Scene& scene);

} // namespace kestrel
