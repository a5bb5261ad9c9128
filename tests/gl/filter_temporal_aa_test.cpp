// Temporal anti-aliasing: what must hold to the bit, what a picture at rest converges to, what is left of
// what moved.
#include "draw/view_data.h"
#include "filter_fixture.h"
#include <cmath>

namespace kestrel::test {
namespace {

using Settings = std::vector<std::string>;

struct TemporalAntiAliasing : FilterTest {
    static Graph graph(const FrameImages& given, const Settings& settings = {}) {
        return graphOf("TemporalAA", given, settings);
    }
    static Image resolved(const FrameImages& given, int frames, const Settings& settings = {}) {
        GivenRenderer made(graph(given, settings), size);
        for (int i = 0; i < frames; ++i) made.frame();
        return made.read(result);
    }
    // A wall with a picture on it; normals and weights are not asked for.
    static FrameImages wallWith(std::function<Image(std::uint32_t)> picture) {
        FrameImages given = wall(size);
        given.erase("normal");
        given["signal"] = std::move(picture);
        return given;
    }
    // One sample a pixel of a picture, at the frame's jitter. Coordinates as the view's: y goes up.
    static std::function<Image(std::uint32_t)> sampled(float (*picture)(float x, float y)) {
        return [picture](std::uint32_t frame) {
            const glm::vec2 jitter = jitterOf(frame);
            Image image = uniform(size, 1, 0);
            for (int y = 0; y < image.height; ++y)
                for (int x = 0; x < image.width; ++x)
                    image.at(x, y) = picture(static_cast<float>(x) + 0.5f + jitter.x,
                                             static_cast<float>(image.height - y) - 0.5f + jitter.y);
            return image;
        };
    }
    static Image meanOfFrames(const std::function<Image(std::uint32_t)>& frames) {
        Image mean = uniform(size, 1, 0);
        for (std::uint32_t i = 0; i < jitterPeriod; ++i) {
            const Image image = frames(i);
            for (size_t k = 0; k < mean.values.size(); ++k)
                mean.values[k] += image.values[k] / static_cast<float>(jitterPeriod);
        }
        return mean;
    }
};

// Slanted bars of several pixels, and a line thinner than a pixel.
float bars(float x, float y) { return std::sin(0.5f * x + 0.21f * y) > 0.1f ? 1.0f : 0.2f; }
float thinLine(float x, float y) { return std::abs(x - 10 - 0.4f * y) < 0.35f ? 1.0f : 0.0f; }

TEST_F(TemporalAntiAliasing, AConstantStaysItselfToTheBit) {
    for (const float value : {0.7f, 1e-20f, 3e4f})
        for (const int channels : {1, 4}) {
            FrameImages given = wallWith(always(uniform(size, channels, value)));
            given["motion"] = always(uniform(size, 2, 0.37f));
            const std::string colours = "given.colours=" + std::to_string(channels);
            for (const float out : resolved(given, 15, {colours}).values) ASSERT_EQ(out, value);
            if (value > 1) continue;
            for (const float out : resolved(given, 15, {colours, "filter.tame=true"}).values)
                ASSERT_NEAR(out, value, 1e-6f * value);
        }
}

TEST_F(TemporalAntiAliasing, APictureAtRestConvergesToTheMeanOverThePixel) {
    for (const auto picture : {bars, thinLine}) {
        const auto frames = sampled(picture);
        const Image mean = meanOfFrames(frames);
        const FrameImages given = wallWith(frames);
        GivenRenderer made(graph(given, {"given.jitter=true"}), size);
        for (int i = 0; i < 64; ++i) made.frame();
        Image average = uniform(size, 1, 0);
        double worst = 0;
        for (std::uint32_t i = 0; i < jitterPeriod; ++i) {
            made.frame();
            const Image now = made.read(result);
            worst = std::max(worst, difference(now, mean).rms);
            for (size_t k = 0; k < average.values.size(); ++k)
                average.values[k] += now.values[k] / static_cast<float>(jitterPeriod);
        }
        const double single = difference(frames(0), mean).rms;
        EXPECT_LE(worst, 0.3 * single);
        EXPECT_LE(difference(average, mean).rms, 0.02);
        EXPECT_NEAR(meanOf(average), meanOf(mean), 0.01);
    }
}

TEST_F(TemporalAntiAliasing, ARenderedSceneConvergesToItsJitteredFrames) {
    Graph scene = shippedGraph("antialiased_ao", {"aa.colour=gbuffer.albedo"});
    GraphPass mean;
    mean.name = "mean";
    mean.type = "Accumulate";
    scene.passes.push_back(mean);
    scene.edges.push_back({{"gbuffer", "albedo"}, {"mean", "signal"}, {}});
    scene.outputs = {{{"aa", "result"}, {}}, {{"mean", "result"}, {}}, {{"gbuffer", "albedo"}, {}}};
    RenderOptions options;
    options.checkFinite = true;
    Renderer made = renderer(scene, loadScene("builtin:hall?detail=0.05"), options, {160, 90, 1});
    for (std::uint32_t i = 0; i < jitterPeriod; ++i) made.frame();
    const Image reference = made.read({"mean", "result"});
    const auto rgb = [](const Image& image) { return convertChannels(image, 3); };
    const double raw = difference(rgb(reference), rgb(made.read({"gbuffer", "albedo"}))).rms;
    const double out = difference(rgb(reference), rgb(made.read({"aa", "result"}))).rms;
    EXPECT_GT(raw, 0.01);
    EXPECT_LE(out, 0.3 * raw);
}

TEST_F(TemporalAntiAliasing, NothingIsLeftOfWhatHasLeft) {
    // A bright square in front of a dark wall: it stands and jumps away, or moves right by a pixel and a half
    // a frame.
    for (const bool jumps : {true, false}) {
        const auto inside = [jumps](int x, int y, std::uint32_t frame) {
            const int left =
                jumps ? (frame < 30 ? 8 : 1000) : static_cast<int>(1.5f * static_cast<float>(frame)) - 10;
            return x >= left && x < left + 12 && y >= 10 && y < 22;
        };
        const auto filled = [&](Extent extent, int channels, float without, float with) {
            return [=](std::uint32_t frame) {
                Image image = uniform(extent, channels, without);
                for (int y = 0; y < image.height; ++y)
                    for (int x = 0; x < image.width; ++x)
                        if (inside(x, y, frame)) image.at(x, y) = with;
                return image;
            };
        };
        FrameImages given = wallWith(filled(size, 1, 0.1f, 1));
        given["depth"] = filled(size, 1, depthAt(4), depthAt(2));
        if (!jumps) given["motion"] = filled(size, 2, 0, -1.5f);
        GivenRenderer made(graph(given), size);
        for (int i = 0; i < 40; ++i) made.frame(); // the last one has the index 39
        const Image out = made.read(result);
        // Where the square was 10 frames ago and is no longer, nor next to it.
        for (int y = 0; y < out.height; ++y)
            for (int x = 0; x < out.width; ++x) {
                if (!inside(x, y, 29) || inside(x + 2, y, 39) || inside(x, y, 39)) continue;
                EXPECT_NEAR(out.at(x, y), 0.1f, 0.02f * 0.9f) << x << " " << y << " " << jumps;
            }
    }
}

TEST_F(TemporalAntiAliasing, ALightThatGoesOutIsForgotten) {
    const FrameImages given =
        wallWith([](std::uint32_t frame) { return uniform(size, 1, frame < 30 ? 1.0f : 0.0f); });
    for (const float value : resolved(given, 31).values)
        EXPECT_NEAR(value, 0, 1e-20f); // far outside of the box
}

TEST_F(TemporalAntiAliasing, AMovingPictureStaysSharp) {
    // A wave of 5.2 pixels that moves by half a pixel a frame. Catmull-Rom passes 0.957 of it a frame, so the
    // mean holds 0.1 / (1 - 0.9 * 0.957) = 0.72 of it: rms 0.079. By linear interpolation it would hold 0.39:
    // rms 0.17.
    const auto pattern = [](std::uint32_t frame) {
        Image image = uniform(size, 1, 0);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                image.at(x, y) =
                    0.5f + 0.4f * std::sin(1.2f * (static_cast<float>(x) - 0.5f * static_cast<float>(frame)));
        return image;
    };
    FrameImages given = wallWith(pattern);
    Image motion = uniform(size, 2, 0);
    for (size_t i = 0; i < motion.values.size(); i += 2) motion.values[i] = -0.5f;
    given["motion"] = always(motion);
    EXPECT_LE(difference(resolved(given, 40), pattern(39)).rms, 0.1);
}

TEST_F(TemporalAntiAliasing, ACutStartsAnew) {
    const auto frames = [](std::uint32_t frame) {
        Image image = uniform(size, 1, 0);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) image.at(x, y) = noise(x, y, frame);
        return image;
    };
    const FrameImages given = wallWith(frames);
    GivenRenderer made(graph(given), size);
    for (int i = 0; i < 10; ++i) made.frame();
    made.setTime(0.5);
    made.frame();
    EXPECT_EQ(made.read(result), frames(10));
}

TEST_F(TemporalAntiAliasing, JitterIsNoMotion) {
    Graph scene = shippedGraph("antialiased_ao");
    scene.outputs = {{{"gbuffer", "motion"}, {}}};
    Renderer made = renderer(scene, loadScene("builtin:blob?detail=0.02"));
    for (int i = 0; i < 3; ++i) {
        made.frame();
        for (const float value : made.read({"gbuffer", "motion"}).values) ASSERT_NEAR(value, 0, 1e-3);
    }
}

TEST_F(TemporalAntiAliasing, SaysWhatItLeavesOut) {
    FrameImages given = wallWith(always(uniform(size, 1, 1)));
    given.erase("motion");
    const GivenRenderer made(graph(given), size);
    std::string all;
    for (const LeftOut& left : made.plan().leftOut) all += left.what + ": " + left.why + "\n";
    EXPECT_NE(all.find("reprojection: no motion is connected"), std::string::npos) << all;
}

TEST_F(TemporalAntiAliasing, SmallAndEmptyFramesWork) {
    RenderOptions options;
    options.checkFinite = true;
    for (const Extent& extent : {Extent{1, 1, 1}, Extent{1, 7, 1}, Extent{33, 17, 1}})
        for (const bool empty : {true, false}) {
            Renderer made =
                renderer(shippedGraph("antialiased_ao"),
                         empty ? trianglesScene({}) : loadScene("builtin:blob?detail=0.02"), options, extent);
            for (int i = 0; i < 4; ++i) made.frame();
            for (const float value : made.read({"aa", "result"}).values)
                EXPECT_TRUE(value >= 0 && value <= 1);
        }
}

} // namespace
} // namespace kestrel::test
