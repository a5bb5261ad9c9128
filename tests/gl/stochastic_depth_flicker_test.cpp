// What changes from frame to frame along a slow camera path: stochastic depth maps against rays (Brüll, Kern,
// Grosch 2024, figure 8).
#include "shipped_fixture.h"
#include <cmath>

namespace kestrel::test {
namespace {

const PortRef flickerRays{"ray_svao", "result"}, flickerMap{"second_ao_pass", "result"},
    flickerMask{"first_ao_pass", "mask"}, flickerDepth{"depth_map", "view_depth"},
    flickerMotion{"depth_map", "motion"};

struct Flicker : ShippedTest {
    static constexpr Extent size{320, 180, 1};
    struct Path {
        std::string scene;           // empty: the slatted shelf
        glm::vec3 eye, target, step; // of the eye and its target, a frame
        float degrees;
    };
    struct Frames {
        std::vector<std::map<std::string, Image>> seen; // by the port's pass and name
        [[nodiscard]] const Image& at(size_t frame, const PortRef& port) const {
            return seen[frame].at(port.text());
        }
    };

    static CameraState camera(const Path& path, size_t frame) {
        const glm::vec3 moved = static_cast<float>(frame) * path.step;
        CameraState state;
        state.position = path.eye + moved;
        state.view = glm::lookAt(state.position, path.target + moved, glm::vec3(0, 1, 0));
        state.verticalFov = glm::radians(path.degrees);
        state.nearPlane = 0.05f;
        state.farPlane = 0;
        return state;
    }
    static Frames frames(const Path& path, const Scene& scene, std::vector<std::string> settings,
                         const std::vector<PortRef>& ports, size_t count) {
        settings.insert(settings.begin(), {"first_ao_pass.exponent=4", "first_ao_pass.cutoff=2",
                                           "depth_map.guard=0", "first_ao_pass.guard=64"});
        Graph graph = shippedGraph("svao", settings);
        graph.outputs.clear();
        for (const PortRef& port : ports) graph.outputs.push_back({port, {}});
        RenderOptions options;
        options.size = size;
        Renderer made(graph, shipped(), scene, context().capabilities(), options);
        Frames all;
        for (size_t i = 0; i < count; ++i) {
            made.setFreeCamera(camera(path, i));
            made.frame();
            all.seen.emplace_back();
            for (const PortRef& port : ports) all.seen.back().emplace(port.text(), made.read(port));
        }
        return all;
    }
    // Calls visit(frame, x, y, change) for each refined pixel whose surface the frame before saw too: the
    // change of `value(frame, x, y)` since then, each surface point followed by its motion. `known` has
    // depth, motion and mask.
    template<class Value, class Visit>
    static void follow(const Frames& known, const Value& value, const Visit& visit) {
        for (size_t f = 1; f < known.seen.size(); ++f) {
            const Image &depth = known.at(f, flickerDepth), &lastDepth = known.at(f - 1, flickerDepth),
                        &motion = known.at(f, flickerMotion), &mask = known.at(f, flickerMask);
            for (int y = 0; y < depth.height; ++y)
                for (int x = 0; x < depth.width; ++x) {
                    const float z = depth.at(x, y);
                    if (mask.at(x, y) == 0 || z == 0) continue;
                    // Rows count downwards, motion up.
                    const float px = static_cast<float>(x) + motion.at(x, y, 0),
                                py = static_cast<float>(y) - motion.at(x, y, 1);
                    const float left = std::floor(px), top = std::floor(py);
                    if (left < 0 || top < 0 || left + 1 >= static_cast<float>(depth.width) ||
                        top + 1 >= static_cast<float>(depth.height))
                        continue;
                    bool same = true;
                    double before = 0;
                    for (int k = 0; k < 4; ++k) {
                        const int ax = static_cast<int>(left) + (k & 1),
                                  ay = static_cast<int>(top) + (k >> 1);
                        same &= std::abs(lastDepth.at(ax, ay) - z) < 0.02f * z;
                        before += value(f - 1, ax, ay) * double{((k & 1) != 0 ? px - left : 1 - px + left) *
                                                                ((k >> 1) != 0 ? py - top : 1 - py + top)};
                    }
                    if (same) visit(f, x, y, value(f, x, y) - before);
                }
        }
    }
    // Mean difference of consecutive frames over refined pixels.
    static double reprojected(const Frames& pictures, const PortRef& port, const Frames& known) {
        double sum = 0, number = 0;
        follow(
            known, [&](size_t f, int x, int y) { return double{pictures.at(f, port).at(x, y)}; },
            [&](size_t, int, int, double change) {
                sum += std::abs(change);
                ++number;
            });
        EXPECT_GT(number, 2000);
        return sum / number;
    }
    // The same of what the map shows and rays do not, of the means over blocks as large as the jitter's
    // pattern: what changes together.
    static double coherent(const Frames& seen) {
        constexpr int block = 16;
        std::map<std::tuple<size_t, int, int>, double> sums;
        double number = 0;
        follow(
            seen,
            [&](size_t f, int x, int y) {
                return double{seen.at(f, flickerMap).at(x, y)} - double{seen.at(f, flickerRays).at(x, y)};
            },
            [&](size_t f, int x, int y, double change) {
                sums[{f, x / block, y / block}] += change;
                ++number;
            });
        double total = 0;
        for (const auto& [at, sum] : sums) total += std::abs(sum);
        return total / number;
    }
};

TEST_F(Flicker, OfAMapIsLittleMoreThanThatOfRays) {
    const Path paths[] = {
        {"builtin:tower?detail=0.3", {4.6f, 7.2f, 5.4f}, {0.4f, 5.3f, 0}, {0.012f, 0.004f, -0.008f}, 60},
        {"builtin:hall?detail=0.3", {0.9f, 1.75f, 10.6f}, {-0.1f, 3, 0}, {0.01f, 0, -0.03f}, 58},
        {"builtin:grove?detail=0.2", {0.2f, 1.75f, 11.5f}, {0.5f, 1.9f, 0}, {0.012f, 0, -0.01f}, 52},
    };
    for (const Path& path : paths) {
        const Scene scene = loadScene(path.scene);
        const std::vector<PortRef> ports = {flickerRays, flickerMap, flickerDepth, flickerMotion,
                                            flickerMask};
        const Frames seen = frames(path, scene, {"first_ao_pass.radius=0.4"}, ports, 4);
        const double rays = reprojected(seen, flickerRays, seen), map = reprojected(seen, flickerMap, seen);
        EXPECT_GT(rays, 0.01) << path.scene;
        EXPECT_LE(map, 1.25 * rays) << path.scene;
        RecordProperty(path.scene, fmt::format("{}", map / rays));
        // Edges cross the map's rows at every angle here: nothing passes together, whether texels are
        // jittered or not. Jitter must not add to what does.
        const Frames still =
            frames(path, scene, {"first_ao_pass.radius=0.4", "sd_map.jitter=false"}, ports, 4);
        const double with = coherent(seen), without = coherent(still);
        RecordProperty(path.scene + " coherent", fmt::format("{}", with / without));
        EXPECT_LE(with, 1.25 * without) << path.scene;
    }
}

// Two triangles.
void addQuad(std::vector<glm::vec3>& corners, glm::vec3 a, glm::vec3 right, glm::vec3 up) {
    corners.insert(corners.end(), {a, a + right, a + right + up, a, a + right + up, a + up});
}

// What figure 8 and section 4.2 ("flickering artifacts near edges") show is an edge along the rows of the
// map: the samples of a whole row of texels pass it in one frame. Its measure is what changes together: the
// change, from one frame to the next, of sums over bands of one jitter pattern's width along the edge, beyond
// what changes of rays. The mean difference of pixels cannot tell it: a sample passes the edge as often with
// jitter as without.
//
// Behind slats across it a shelf on a wall, its edges along the rows or the columns of the map.
TEST_F(Flicker, JitterHalvesTheJumpsOfEdgesAlongTheMap) {
    constexpr float pixelsPerUnit = 180, depth = 5.5f;
    for (const bool upright : {false, true}) {
        std::vector<glm::vec3> corners;
        addQuad(corners, {-8, -8, -6}, {16, 0, 0}, {0, 16, 0});
        addQuad(corners, {-8, -0.2f, -depth}, {16, 0, 0}, {0, 0.4f, 0});
        for (const float y : {-0.2f, 0.2f}) addQuad(corners, {-8, y, -6}, {16, 0, 0}, {0, 0, 6 - depth});
        for (int i = -8; i <= 8; ++i)
            addQuad(corners, {0.4f * static_cast<float>(i), -3, -2}, {0.12f, 0, 0}, {0, 6, 0});
        // One pixel a frame, across the edges.
        Path path{"",
                  {0, 0, 0},
                  {0, 0, -1},
                  {0, depth / pixelsPerUnit, 0},
                  glm::degrees(2 * std::atan(0.5f * static_cast<float>(size.height) / pixelsPerUnit))};
        const auto turn = [&](glm::vec3& v) { v = upright ? glm::vec3(v.y, v.x, v.z) : v; };
        for (glm::vec3& corner : corners) turn(corner);
        turn(path.step);
        const size_t count = 9;
        const auto jumps = [&](const char* jitter) {
            const Frames seen = frames(path, trianglesScene(corners), {"first_ao_pass.radius=0.8", jitter},
                                       {flickerRays, flickerMap, flickerMask}, count);
            constexpr int band = 16;
            double sum = 0;
            std::map<int, double> last;
            for (size_t f = 0; f < count; ++f) {
                std::map<int, double> now;
                const Image &rays = seen.at(f, flickerRays), &map = seen.at(f, flickerMap);
                for (int y = 0; y < rays.height; ++y)
                    for (int x = 0; x < rays.width; ++x)
                        now[(upright ? x : y) / band] += double{map.at(x, y)} - double{rays.at(x, y)};
                if (f > 0)
                    for (const auto& [at, value] : now) sum += std::abs(value - last[at]);
                last = now;
            }
            return sum;
        };
        const double with = jumps("sd_map.jitter=true"), without = jumps("sd_map.jitter=false");
        RecordProperty(upright ? "columns" : "rows", fmt::format("{}", with / without));
        EXPECT_GT(without, 1);
        EXPECT_LE(with, 0.5 * without) << upright;
    }
}

} // namespace
} // namespace kestrel::test
