// glTF files, .gltf and .glb told by their first bytes, with neighbours to name: "data.bin", "picture.png".
#include "fuzz.h"
#include "image/io.h"
#include "scene/gltf_export.h"
#include "scene/gltf_import.h"
#include "scene/setup.h"
#include <string>

namespace {

const std::filesystem::path& sceneFile() {
    using namespace kestrel;
    static const std::filesystem::path file = [] {
        std::string data(512, '\0');
        for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<char>(i % 3);
        writeFile(fuzz::folder() / "data.bin", data);
        writeImage(fuzz::folder() / "picture.png", Image(2, 2, 4, 0.5F), Encoding::Linear);
        return fuzz::folder() / "scene.gltf";
    }();
    return file;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace kestrel;
    // As the program's own, but as small as a run of thousands a second needs.
    GltfLimits limits;
    limits.jsonValues = 20'000;
    limits.pixels = limits.decodedPixels = 1 << 20;
    limits.decodedBytes = limits.storedBytes = 1 << 22;
    limits.joints = limits.instances = limits.triangles = 1 << 14;
    writeFile(sceneFile(), fuzz::bytesOf(data, size));
    Scene scene;
    if (!fuzz::taken([&] {
            scene = importGltf(sceneFile(), {}, limits);
            setUpScene(scene, {}, fuzz::folder().path());
        }))
        return 0;
    // What was taken can be written and is taken again.
    writeFile(sceneFile(), exportedGlb(scene));
    importGltf(sceneFile());
    return 0;
}
