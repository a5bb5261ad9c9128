// Cameras with their paths, and lights: as files, and as the texts of the command line.
#include "fuzz.h"
#include "scene/geometry.h"
#include "scene/setup.h"
#include <cmath>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace kestrel;
    const std::string text(fuzz::textOf(data, size));
    writeFile(fuzz::folder() / "path.json", text);
    SceneSetup setup;
    setup.camera.emplace().path = "path.json";
    fuzz::taken([&] {
        Scene scene;
        setUpScene(scene, setup, fuzz::folder().path());
        const double duration = scene.duration();
        for (const double part : {-1.0, 0.0, 0.3, 1.0, 2.0}) {
            const CameraState seen = cameraAt(scene, scene.camera, part * duration);
            for (int column = 0; column < 4; ++column)
                for (int row = 0; row < 4; ++row) KESTREL_CHECK(std::isfinite(seen.view[column][row]));
        }
    });
    AddedCamera camera;
    if (fuzz::taken([&] { camera = parseCamera(text, "camera"); })) {
        const std::string written = cameraText(camera);
        KESTREL_CHECK_EQ(cameraText(parseCamera(written, "camera")), written);
    }
    AddedLight light;
    if (fuzz::taken([&] { light = parseLight(text, "light"); })) {
        const std::string written = lightText(light);
        KESTREL_CHECK_EQ(lightText(parseLight(written, "light")), written);
    }
    return 0;
}
