// The occupancy map: methods that claim the same bits, the exact one against an oracle, extreme scenes.
#include "gl/occupancy_fixture.h"
#include "passes/occupancy_oracle.h"
#include <gmock/gmock.h>

namespace kestrel::test {
namespace {

using OccupancyMapGl = GlTest;

std::string properties(int n, const std::string& method) {
    return R"("resolution": )" + std::to_string(n) + R"(, "method": ")" + method + '"';
}

std::vector<std::uint32_t> mapOf(const Scene& scene, int n, const std::string& method) {
    Renderer renderer = mapRenderer(scene, properties(n, method));
    renderer.frame();
    return wordsOf(renderer, {"map", "occupancy"});
}

// Triangles that are hard to place: without area, thin, on the borders between cells, the whole cube's size.
std::vector<glm::vec3> hardTriangles() {
    const glm::vec3 a(-0.9f, 0, 0), b(0.9f, 0, 0), c(0, 0.9f, 0);
    std::vector<glm::vec3> corners = {
        a,
        a,
        a, // a point
        a,
        b,
        b, // a segment
        a,
        glm::vec3(0),
        b, // three points in a row
        a,
        b,
        glm::vec3(0, 1e-6f, 0), // a sliver
        glm::vec3(-0.5f, -0.5f, -0.5f),
        glm::vec3(0.5f),
        glm::vec3(0.5f, 0.5f, 0.49999f), // a slanted one
        glm::vec3(-0.7f, 0, -0.7f),
        glm::vec3(0.7f, 0, -0.7f),
        glm::vec3(0, 0, 0.95f), // between cells, large
        a,
        b,
        c,
        glm::vec3(0.25f, 0.25f, 0),
        glm::vec3(0.5f, 0.25f, 0),
        glm::vec3(0.25f, 0.5f, 0),
        glm::vec3(0, 0, 1),
        glm::vec3(0, 0, -1),
        glm::vec3(0, 1, 0),
    };
    const std::vector<glm::vec3> more = randomTriangles(60, 11);
    corners.insert(corners.end(), more.begin(), more.end());
    return corners;
}

TEST_F(OccupancyMapGl, ThreeAxisMethodsGiveTheSameBits) {
    const Scene scene = sceneOf(hardTriangles());
    for (const int n : {32, 64, 128, 256}) {
        const std::vector<std::uint32_t> reference = mapOf(scene, n, "three_axis");
        EXPECT_GT(setBits(reference), 100u);
        EXPECT_EQ(mapOf(scene, n, "logic_op"), reference) << n;
        for (const auto& [method, extension] :
             {std::pair("framebuffer_fetch", "GL_EXT_shader_framebuffer_fetch"),
              std::pair("interlock", "GL_ARB_fragment_shader_interlock")})
            if (context().capabilities().has(extension)) {
                EXPECT_EQ(mapOf(scene, n, method), reference) << method;
            }
    }
}

// What a rasterizer marks, a triangle meets; what it misses are cells that a surface crosses beside their
// centre lines.
TEST_F(OccupancyMapGl, RasterizedCellsAreMetByTriangles) {
    const Scene scene = loadScene("builtin:blob?detail=0.1");
    for (const int n : {32, 128}) {
        const std::vector<std::uint32_t> exact = mapOf(scene, n, "exact");
        for (const char* method : {"three_axis", "dominant_axis"}) {
            Renderer renderer = mapRenderer(scene, properties(n, method) + R"(, "inset": 0)");
            renderer.frame();
            const std::vector<std::uint32_t> map = wordsOf(renderer, {"map", "occupancy"});
            size_t extra = 0;
            for (size_t i = 0; i < map.size(); ++i)
                extra += static_cast<size_t>(std::popcount(map[i] & ~exact[i]));
            // The rasterizer snaps corners to a grid of 1/256 pixel.
            EXPECT_LT(extra, setBits(exact) / 500) << method;
            EXPECT_GT(setBits(map), setBits(exact) * 11 / 20) << method;
            EXPECT_LT(setBits(map), setBits(exact)) << method;
        }
    }
}

TEST_F(OccupancyMapGl, ExactEqualsTheOracle) {
    for (const float scale : {1.0f, 1e-4f, 1e4f}) {
        std::vector<glm::vec3> corners = hardTriangles();
        for (glm::vec3& corner : corners) corner *= scale;
        const Scene scene = sceneOf(corners);
        for (const int n : {32, 64}) {
            Renderer renderer = mapRenderer(scene, properties(n, "exact"));
            renderer.frame();
            const Geometry geometry = flatten(scene, 0);
            const auto expected = oracleMap(geometry, gridOf(renderer));
            const auto map = wordsOf(renderer, {"map", "occupancy"});
            EXPECT_GT(setBits(map), 100u);
            EXPECT_EQ(map, expected) << "scale " << scale << ", " << n << " cells";
        }
    }
}

// One- and two-sided surfaces, small and large triangles, at one inset.
TEST_F(OccupancyMapGl, SeparatingEqualsItsOracle) {
    for (const bool doubleSided : {false, true})
        for (const float scale : {1.0f, 1e4f}) {
            std::vector<glm::vec3> corners = hardTriangles();
            for (glm::vec3& corner : corners) corner *= scale;
            Scene scene = sceneOf(corners);
            Material material;
            material.doubleSided = doubleSided;
            scene.materials = {material};
            for (Primitive& primitive : scene.meshes[0].primitives) primitive.material = 0;
            finishScene(scene);
            for (const int n : {32, 128}) {
                Renderer renderer = mapRenderer(scene, properties(n, "separating") + R"(, "inset": 0.375)");
                renderer.frame();
                const auto map = wordsOf(renderer, {"map", "occupancy"});
                EXPECT_GT(setBits(map), 100u);
                EXPECT_EQ(map,
                          separatingOracle(flatten(scene, 0), gridOf(renderer), doubleSided ? 0 : 0.375f))
                    << "scale " << scale << ", " << n << " cells";
            }
        }
}

// One triangle over the whole cube at the finest resolution: over 65,535 cells in one triangle's box.
TEST_F(OccupancyMapGl, HugeTrianglesLoseNothing) {
    const Scene scene =
        sceneOf({{-1, -1, -1}, {1, 1, -0.9f}, {-1, 1, 1}, {-1, 0, -1}, {1, 0, -1}, {0, 0, 1}});
    Renderer renderer = mapRenderer(scene, properties(256, "exact"));
    renderer.frame();
    const auto expected = oracleMap(flatten(scene, 0), gridOf(renderer));
    EXPECT_GT(setBits(expected), 30'000u);
    EXPECT_EQ(wordsOf(renderer, {"map", "occupancy"}), expected);
}

TEST_F(OccupancyMapGl, EmptyAndPointScenesAreValidAndEmpty) {
    const glm::vec3 point(3, 4, 5);
    for (const Scene& scene : {emptyScene(), sceneOf({point, point, point})}) {
        for (const char* method : {"three_axis", "logic_op", "dominant_axis", "exact", "separating"}) {
            Renderer renderer = mapRenderer(scene, properties(32, method));
            renderer.frame();
            EXPECT_EQ(setBits(wordsOf(renderer, {"map", "occupancy"})), 0u);
            EXPECT_GT(gridOf(renderer).cellSize, 0.0f);
            EXPECT_FALSE(renderer.plan().leftOut.empty());
        }
    }
}

TEST_F(OccupancyMapGl, OneTriangleIsSomewhereInTheMap) {
    for (const char* method : {"three_axis", "logic_op", "dominant_axis", "exact", "separating"}) {
        const size_t bits = setBits(mapOf(sceneOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), 32, method));
        EXPECT_GT(bits, 200u) << method;
        EXPECT_LT(bits, 1200u) << method;
    }
}

// The surface of a box, front faces outside.
Scene boxScene(const glm::vec3& extent, bool doubleSided) {
    std::vector<glm::vec3> corners;
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0f, 1.0f}) {
            const auto at = [&](float u, float v) {
                glm::vec3 p(0);
                p[axis] = side * extent[axis];
                p[(axis + 1) % 3] = side * u * extent[(axis + 1) % 3];
                p[(axis + 2) % 3] = v * extent[(axis + 2) % 3];
                return p;
            };
            for (const glm::vec3& p : {at(-1, -1), at(1, -1), at(1, 1), at(-1, -1), at(1, 1), at(-1, 1)})
                corners.push_back(p);
        }
    }
    Scene scene = sceneOf(corners);
    Material material;
    material.doubleSided = doubleSided;
    scene.materials = {material};
    scene.meshes[0].primitives[0].material = 0;
    finishScene(scene);
    return scene;
}

struct CellBox {
    glm::ivec3 low{1 << 20}, high{-1};
};

CellBox occupiedBox(const std::vector<std::uint32_t>& map, int n) {
    CellBox box;
    for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x)
                if (isSet(map, n, {x, y, z})) {
                    box.low = glm::min(box.low, glm::ivec3(x, y, z));
                    box.high = glm::max(box.high, glm::ivec3(x, y, z));
                }
    return box;
}

// Every face of a box is marked where it would be if it lay so far inside, whichever way it looks; one with
// two sides where it lies. Edges apart, which cells' centre lines may miss: the box is many cells wide.
TEST_F(OccupancyMapGl, OneSidedSurfacesAreMarkedBehind) {
    constexpr int n = 64;
    int moved = 0;
    for (const char* method : {"three_axis", "logic_op", "dominant_axis", "separating"})
        for (const float inset : {0.0f, 0.25f, 0.5f})
            for (const bool doubleSided : {false, true})
                for (const glm::vec3& extent : {glm::vec3(1, 0.61f, 0.37f), glm::vec3(0.53f, 0.97f, 0.83f),
                                                glm::vec3(0.71f, 0.43f, 1)}) {
                    Renderer renderer =
                        mapRenderer(boxScene(extent, doubleSided),
                                    properties(n, method) + R"(, "inset": )" + std::to_string(inset));
                    renderer.frame();
                    const CellBox box = occupiedBox(wordsOf(renderer, {"map", "occupancy"}), n);
                    const shared::OccupancyGrid grid = gridOf(renderer);
                    const float behind = doubleSided ? 0 : inset;
                    const glm::vec3 low = shared::cellsOf(grid, -extent),
                                    high = shared::cellsOf(grid, extent);
                    EXPECT_EQ(box.low, glm::ivec3(glm::floor(low + behind))) << method << " " << inset;
                    EXPECT_EQ(box.high, glm::ivec3(glm::floor(high - behind))) << method << " " << inset;
                    moved += box.low != glm::ivec3(glm::floor(low));
                    moved += box.high != glm::ivec3(glm::floor(high));
                }
    EXPECT_GT(moved, 10);
}

// Scale and place change nothing but rounding.
TEST_F(OccupancyMapGl, ScaledScenesHaveTheSameMap) {
    for (const char* method : {"three_axis", "exact", "separating"}) {
        const std::vector<std::uint32_t> reference = mapOf(sceneOf(randomTriangles(100, 9)), 64, method);
        for (const float scale : {1e-4f, 1e4f}) {
            const auto map = mapOf(sceneOf(randomTriangles(100, 9, scale)), 64, method);
            size_t differing = 0;
            for (size_t i = 0; i < map.size(); ++i)
                differing += static_cast<size_t>(std::popcount(map[i] ^ reference[i]));
            EXPECT_LT(differing, setBits(reference) / 200) << method << " " << scale;
        }
    }
}

TEST_F(OccupancyMapGl, JitterMovesTheCellsEveryFrameAndRepeats) {
    const Scene scene = sceneOf(randomTriangles(50, 9));
    Renderer renderer = mapRenderer(scene, properties(32, "exact") + R"(, "jitter": true)");
    std::vector<glm::vec3> centres;
    for (int i = 0; i < 8; ++i) {
        renderer.frame();
        const shared::OccupancyGrid grid = gridOf(renderer);
        const glm::vec3 shift = (grid.centre - renderer.facts().sphere.centre) * grid.inverseCellSize;
        for (int k = 0; k < 3; ++k) EXPECT_LE(std::abs(shift[k]), 0.5001f);
        for (const glm::vec3& other : centres) EXPECT_NE(grid.centre, other);
        centres.push_back(grid.centre);
        EXPECT_EQ(wordsOf(renderer, {"map", "occupancy"}), oracleMap(flatten(scene, 0), grid));
    }
    Renderer again = mapRenderer(scene, properties(32, "exact") + R"(, "jitter": true)");
    for (const glm::vec3& centre : centres) {
        again.frame();
        EXPECT_EQ(gridOf(again).centre, centre);
    }
}

// A static map is built once.
TEST_F(OccupancyMapGl, RunsOnlyWhenSomethingChanges) {
    RenderOptions options;
    options.timing = true;
    Renderer renderer = mapRenderer(sceneOf(randomTriangles(5, 9)), properties(32, "exact"), options);
    EXPECT_GT(renderer.frame().samples.size(), 2u);
    EXPECT_TRUE(renderer.frame().samples.empty());
}

// A quad whose left half is cut out by its texture.
Scene halfQuad() {
    Scene scene;
    Primitive quad;
    quad.positions = {{-1, -1, 0.03f}, {1, -1, 0.03f}, {1, 1, 0.03f}, {-1, 1, 0.03f}};
    quad.texCoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    quad.indices = {0, 1, 2, 0, 2, 3};
    quad.material = 0;
    TextureImage image{"half", 16, 16, {}};
    for (int i = 0; i < 256; ++i)
        for (const int value : {255, 255, 255, i % 16 < 8 ? 0 : 255})
            image.rgba.push_back(static_cast<std::uint8_t>(value));
    scene.images = {image};
    Material material;
    material.alphaMode = AlphaMode::Mask;
    material.doubleSided = true;
    material.baseColourTexture.image = 0;
    material.baseColourTexture.nearest = true;
    scene.materials = {material};
    scene.meshes = {{"quad", {quad}, {}}};
    Node node;
    node.mesh = 0;
    scene.nodes = {node};
    scene.roots = {0};
    finishScene(scene);
    return scene;
}

TEST_F(OccupancyMapGl, AlphaTestsMakeHoles) {
    for (const char* method : {"three_axis", "logic_op", "dominant_axis", "exact", "separating"}) {
        Renderer renderer = mapRenderer(halfQuad(), properties(64, method));
        renderer.frame();
        const auto map = wordsOf(renderer, {"map", "occupancy"});
        const shared::OccupancyGrid grid = gridOf(renderer);
        int wrong = 0, checked = 0;
        for (float y = -0.9f; y < 0.9f; y += 0.1f) {
            for (float x = -0.9f; x < 0.9f; x += 0.1f) {
                if (std::abs(x) < 0.08f) continue;
                const glm::ivec3 cell(glm::floor(
                    shared::cellsOf(grid, glm::vec3(x, y, 0.03f) - glm::vec3(renderer.scene().origin))));
                wrong += isSet(map, 64, cell) != (x > 0);
                ++checked;
            }
        }
        EXPECT_GT(checked, 200);
        EXPECT_EQ(wrong, 0) << method;
    }
}

TEST_F(OccupancyMapGl, RefusesWhatItCannotDo) {
    const Scene scene = sceneOf(randomTriangles(5, 9));
    EXPECT_THAT(messageOf<InputError>([&] { mapRenderer(scene, R"("resolution": 96)").frame(); }),
                testing::HasSubstr("'resolution': must be 32, 64, 128 or 256, not 96"));
    World world;
    world.facts.triangles = 1;
    world.facts.sphere.radius = 1;
    for (const auto& [method, extension] :
         {std::pair(OccupancyMethod::Interlock, "GL_ARB_fragment_shader_interlock"),
          std::pair(OccupancyMethod::FramebufferFetch, "GL_EXT_shader_framebuffer_fetch")}) {
        OccupancyMap pass;
        pass.method = method;
        const Declaration declaration = pass.declare(world, {}, Demand::everything());
        ASSERT_EQ(declaration.problems.size(), 1u);
        EXPECT_THAT(declaration.problems[0].message, testing::HasSubstr(extension));
    }
}

} // namespace
} // namespace kestrel::test
