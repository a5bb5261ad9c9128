// Writes the inputs that fuzzing begins with: seeds FOLDER makes FOLDER/TARGET/*.
#include "core/files.h"
#include "scene/gltf_export.h"
#include "support/folders.h"
#include "support/temporary_folder.h"
#include "unit/image_samples.h"
#include "unit/scene_gltf_rich.h"
#include <fmt/format.h>

namespace {

namespace fs = std::filesystem;
using namespace kestrel;

// All files of a folder that are small enough to be changed and read thousands of times a second.
void copyFiles(const fs::path& from, const std::string& ending, const fs::path& to) {
    constexpr std::uintmax_t most = 16'384;
    fs::create_directories(to);
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(from))
        if (entry.is_regular_file() && entry.path().extension() == ending && entry.file_size() <= most)
            fs::copy_file(entry.path(), to / entry.path().filename(), fs::copy_options::overwrite_existing);
}

} // namespace

int main(int count, char** arguments) {
    const fs::path seeds = count > 1 ? arguments[1] : "seeds";
    const fs::path source = test::sourceFolder();
    copyFiles(source / "graphs", ".json", seeds / "graph");
    copyFiles(source / "graphs" / "sweeps", ".json", seeds / "sweep");
    copyFiles(source / "tests" / "golden", ".gltf", seeds / "gltf");
    const fs::path corpus = "/usr/share/assimp/models/glTF2"; // the package assimp-testmodels
    if (fs::is_directory(corpus))
        for (const char* ending : {".gltf", ".glb"}) copyFiles(corpus, ending, seeds / "gltf");

    int number = 0;
    for (const test_files::Sample& sample : test_files::samples())
        writeFile(seeds / "image" / fmt::format("{}", number++), sample.bytes);

    const test::TemporaryFolder folder;
    const test::GltfBuilder rich = test::richFile();
    writeFile(folder / "rich.gltf", rich.text());
    writeFile(seeds / "gltf" / "rich.gltf", rich.text());
    writeFile(seeds / "gltf" / "rich.glb", exportedGlb(loadScene((folder / "rich.gltf").string())));
    test::GltfBuilder beside = test::triangleFile();
    beside.document["buffers"] = {{{"byteLength", 512}, {"uri", "data.bin"}}};
    beside.document["images"] = {{{"uri", "picture.png"}}};
    writeFile(seeds / "gltf" / "beside.gltf", beside.text());

    const char* const cameras[] = {
        "eye=0,2,0 target=1,2,0 fov=60 near=0.1 far=100 up=0,1,0 name=a",
        R"({"kestrel_camera": 1, "eye": [0, 2, 0], "fov": 45, "interpolation": "smooth", "keys": [
            {"time": 0, "target": [1, 2, 3]}, {"time": 1.5, "target": [1, 2, 4], "up": [0, 0, 1], "fov": 60}]})",
        R"({"kestrel_camera": 1, "eye": [0, 2, 0], "target": [3, 2, 1], "near": 0.1, "far": 1e3})",
        "spot position=0,2,0 direction=0,-1,0 color=1,1,1 intensity=3 inner=10 outer=30 range=9",
        "rectangle position=0,2,0 target=0,0,0 width=1 height=2 up=1,0,0",
        R"({"kind": "sphere", "position": [0, 1, 2], "radius": 0.5, "name": "lamp"})",
    };
    for (number = 0; const char* text : cameras)
        writeFile(seeds / "camera" / fmt::format("{}", number++), std::string_view(text));
}
