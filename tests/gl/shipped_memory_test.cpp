// A long run takes no more memory than a short one.
#include "shipped_fixture.h"
#include <fstream>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using namespace test;

// The names of GL objects that are alive.
int liveObjects() {
    constexpr GLuint most = 20'000; // drivers give out the least free name
    int alive = 0;
    for (GLuint name = 1; name < most; ++name)
        for (const auto is :
             {glIsTexture, glIsBuffer, glIsFramebuffer, glIsProgram, glIsQuery, glIsVertexArray, glIsSampler})
            if (is(name) == GL_TRUE) ++alive;
    return alive;
}

// Of this process, in MiB; 0 where the system does not tell.
double residentMiB() {
    std::ifstream file("/proc/self/statm");
    double pages = 0, resident = 0;
    file >> pages >> resident;
    return file ? resident * 4096 / (1 << 20) : 0;
}

// The largest graph, on a scene that moves; small maps, for speed.
TEST(ShippedMemory, TwoThousandFramesOfTheLargestGraphTakeNoMore) {
    context();
    RenderOptions options;
    options.timing = true;
    options.size = {32, 18, 1};
    Renderer renderer(shippedGraph("full", {"bom.resolution=32", "rsm.resolution=32"}), shipped(),
                      loadScene("builtin:skinned"), context().capabilities(), options);
    constexpr int warm = 200, frames = 2'000;
    double settled = 0;
    int objects = 0;
    for (int i = 0; i < frames; ++i) {
        renderer.frame();
        if (i != warm) continue;
        settled = residentMiB();
        objects = liveObjects();
    }
    EXPECT_GT(objects, 100);
    EXPECT_EQ(liveObjects(), objects);
    RecordProperty("growth_kib", static_cast<int>(1024 * (residentMiB() - settled)));
    EXPECT_LE(residentMiB() - settled, 4);
}

} // namespace
} // namespace kestrel
