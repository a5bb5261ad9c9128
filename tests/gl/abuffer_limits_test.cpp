// Where an A-buffer's views are at their limits: the eye in a wall or a corner, rays along axes and through
// the corners of the cube, pixels with one depth, views without fragments. With fragments and with
// primitives.
#include "abuffer_rays_fixture.h"
#include <functional>

namespace kestrel::test {
namespace {

struct ABufferLimits : ABufferRays {
    using Distance = std::function<float(const glm::vec3&)>;

    // All 26 directions of axes and diagonals from each place, and `count` others.
    static std::vector<shared::RayRecord> around(const std::vector<glm::vec3>& places, int count,
                                                 float tMin) {
        std::mt19937 random(5);
        std::uniform_real_distribution<float> unit(-1, 1);
        std::vector<shared::RayRecord> rays;
        for (const glm::vec3& from : places) {
            for (int i = 0; i < 27; ++i)
                if (i != 13)
                    rays.push_back(rayRecord(from, glm::vec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1), {}, tMin));
            for (int i = 0; i < count; ++i)
                rays.push_back(
                    rayRecord(from, glm::vec3(unit(random), unit(random), unit(random)), {}, tMin));
        }
        return rays;
    }

    // Primitives are hit as the hierarchy says; fragments within three footprints of a surface (half the
    // thickness, and what a surface falls within a pixel and its neighbour), or not at all: at most `lost` of
    // the hits.
    static void expectSoundHits(const Scene& scene, const std::vector<shared::RayRecord>& rays,
                                const Distance& off, double lost, const std::string& what) {
        RaySource::rays = rays;
        const glm::vec3 eye = cameraAt(scene, 0, 0).position;
        for (const char* march : {"exhaustive", "hierarchical"}) {
            const Hits exact =
                hits(scene, "own.rays", {"abuffer.record=primitive", fmt::format("abuffer.march={}", march)});
            const Hits near =
                hits(scene, "own.rays",
                     {"abuffer.thickness=2", "abuffer.offset=0", fmt::format("abuffer.march={}", march)});
            EXPECT_EQ(exact.exhausted, 0) << what;
            EXPECT_EQ(near.exhausted, 0) << what;
            size_t met = 0, missed = 0, without = 0, astray = 0, invented = 0;
            for (size_t i = 0; i < rays.size(); ++i) {
                const float truth = exact.bvh[i].t, t = exact.abuffer[i].t, fragment = near.abuffer[i].t;
                ASSERT_FALSE(std::isnan(t) || std::isnan(fragment)) << what << " " << i;
                met += truth < INFINITY ? 1 : 0;
                // Of surfaces that meet the ray in one place either may have it, by rounding.
                missed += (truth < INFINITY) != (t < INFINITY) || std::abs(t - truth) > 1e-6f * truth ? 1 : 0;
                without += truth < INFINITY && !(fragment < INFINITY) ? 1 : 0;
                invented += !(truth < INFINITY) && fragment < INFINITY ? 1 : 0;
                if (!(fragment < INFINITY)) continue;
                const glm::vec3 place = rays[i].origin + fragment * rays[i].direction,
                                fromEye = glm::abs(place - eye);
                const float footprint = (std::max({fromEye.x, fromEye.y, fromEye.z}) + 0.01f) / 32;
                astray += off(place) > 3 * footprint ? 1 : 0;
            }
            EXPECT_EQ(missed, 0u) << what << " " << march << ", of " << met;
            EXPECT_EQ(astray, 0u) << what << " " << march;
            EXPECT_LE(static_cast<double>(without + invented), lost * static_cast<double>(met))
                << what << " " << march << ": without " << without << ", invented " << invented << " of "
                << met;
            EXPECT_GT(met, 0u) << what;
            RecordProperty(fmt::format("{} {}", what, march),
                           fmt::format("without a fragment {} of {}", without, met));
        }
    }
};

float offRoom(const glm::vec3& p) {
    const glm::vec3 a = glm::abs(p);
    return std::abs(std::max({a.x, a.y, a.z}) - 1);
}

// A quarter may be without: beside an edge of the room the pixel's centre may show the other wall.
TEST_F(ABufferLimits, TheEyeMayStandInAWall) {
    std::vector<glm::vec3> corners = roomWalls();
    addWall(corners, 0, -0.01f);
    addWall(corners, 0, 0.03f);
    const auto off = [](const glm::vec3& p) {
        return std::min({offRoom(p), std::abs(p.x + 0.01f), std::abs(p.x - 0.03f)});
    };
    const glm::vec3 eye(0.01f, 0.2f, -0.1f);
    expectSoundHits(seenFrom(eye, corners), around({eye, {0.5f, 0.1f, 0.2f}, {-0.7f, 0.3f, 0.4f}}, 1000, 0),
                    off, 0.25, "in a wall");
    // And in the plane of one.
    std::vector<glm::vec3> plane = roomWalls();
    addWall(plane, 1, 0);
    const auto offPlane = [](const glm::vec3& p) { return std::min(offRoom(p), std::abs(p.y)); };
    expectSoundHits(seenFrom({0.1f, 0, 0.2f}, plane),
                    around({{0.2f, 0.5f, 0.1f}, {-0.3f, -0.4f, 0.6f}}, 1000, 0), offPlane, 0.25,
                    "in the plane of a wall");
}

TEST_F(ABufferLimits, TheEyeMayStandInACornerOfTheScenesBox) {
    // Three walls go through the eye and have no fragments: only rays to the others can be met, about half of
    // them.
    const glm::vec3 eye(1, 1, 1);
    expectSoundHits(seenFrom(eye, roomWalls()),
                    around({eye, {0.5f, 0.5f, 0.5f}, {-0.4f, 0.2f, 0.1f}}, 1000, 0.1f), offRoom, 0.6,
                    "in a corner");
}

// The edges of the room are those of the cube's faces.
TEST_F(ABufferLimits, RaysMayRunAlongAxesAndThroughEdgesAndCorners) {
    const std::vector<glm::vec3> places = {
        {0, 0, 0}, {0.5f, 0, 0}, {0, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0.5f}};
    expectSoundHits(seenFrom({0, 0, 0}, roomWalls()), around(places, 300, 0), offRoom, 0.25,
                    "edges of faces");
}

TEST_F(ABufferLimits, PixelsWithOneDepthAndViewsWithoutFragments) {
    std::vector<glm::vec3> corners;
    addWall(corners, 2, -2);
    const Scene scene = seenFrom({0, 0, 0}, corners);
    // Where render space has its origin is the scene's choice.
    const glm::vec3 eye = cameraAt(scene, 0, 0).position;
    const auto off = [&](const glm::vec3& p) { return std::abs(p.z - eye.z + 2); };
    // All around, and towards the wall from before and behind.
    const std::vector<glm::vec3> places = {eye, eye + glm::vec3(0.1f, 0.2f, -1), eye + glm::vec3(0, 0, -3),
                                           eye + glm::vec3(0.3f, 0.1f, 1)};
    expectSoundHits(scene, around(places, 1000, 0), off, 0.1, "one wall");
}

} // namespace
} // namespace kestrel::test
