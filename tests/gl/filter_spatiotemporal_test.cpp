// The spatiotemporal filter: what must hold to the bit, the decay of what it misses and what it sees, its
// bias, then real scenes.
#include "filter_fixture.h"
#include <cmath>

namespace kestrel::test {
namespace {

using Settings = std::vector<std::string>;

struct Spatiotemporal : FilterTest {
    static Graph graph(const FrameImages& given, const Settings& settings = {},
                       const std::vector<std::string>& outputs = {"result"}) {
        return graphOf("SpatiotemporalFilter", given, settings, outputs);
    }
    // Result after `frames` frames.
    static Image filtered(const FrameImages& given, int frames, const Settings& settings = {}) {
        GivenRenderer made(graph(given, settings), size);
        for (int i = 0; i < frames; ++i) made.frame();
        return made.read(result);
    }
    // A visibility of one ray: 1 with probability `share`.
    static std::function<Image(std::uint32_t)> coins(float share) {
        return [share](std::uint32_t frame) {
            Image image = uniform(size, 1, 0);
            for (int y = 0; y < image.height; ++y)
                for (int x = 0; x < image.width; ++x)
                    image.at(x, y) = noise(x, y, frame) < share ? 1.0f : 0.0f;
            return image;
        };
    }
    // `before` up to frame `at`, then `after`.
    static std::function<Image(std::uint32_t)> switching(std::uint32_t at,
                                                         std::function<Image(std::uint32_t)> before,
                                                         std::function<Image(std::uint32_t)> after) {
        return [=](std::uint32_t frame) { return frame < at ? before(frame) : after(frame); };
    }
};

const Settings variants[] = {
    {},
    {"filter.iterations=0"},
    {"filter.history=1"},
    {"filter.iterations=1", "filter.filtered_history=true"},
    {"filter.iterations=5", "filter.radius=1", "filter.gradient=true", "filter.clamp=1"}};

TEST_F(Spatiotemporal, AConstantStaysItselfToTheBit) {
    for (const float value : {0.7f, 1e-20f, 3e4f})
        for (const int channels : {1, 4})
            for (const Settings& variant : variants) {
                FrameImages given = wall(size);
                given["signal"] = always(uniform(size, channels, value));
                Image motion = uniform(size, 2, 0.37f); // between pixels: the history is interpolated
                given["motion"] = always(motion);
                Settings settings = variant;
                settings.push_back("given.colours=" + std::to_string(channels));
                for (const float out : filtered(given, 15, settings).values) ASSERT_EQ(out, value);
            }
}

TEST_F(Spatiotemporal, WhatItMissesDecaysAsTheHistoryDoes) {
    for (const Settings& variant :
         {Settings{"filter.iterations=0"}, Settings{}, Settings{"filter.filtered_history=true"}}) {
        FrameImages given = wall(size);
        given["signal"] = switching(20, always(uniform(size, 1, 1)), always(uniform(size, 1, 0)));
        GivenRenderer made(graph(given, variant), size);
        for (int i = 0; i < 20; ++i) made.frame();
        double bound = 1;
        for (int n = 1; n <= 20; ++n) {
            made.frame();
            bound *= 0.9;
            for (const float value : made.read(result).values) ASSERT_LE(value, bound * 1.0001) << n;
        }
    }
}

TEST_F(Spatiotemporal, WeightsOfAnySizeDecayAlike) {
    FrameImages given = wall(size);
    given["signal"] = switching(20, always(uniform(size, 1, 1)), always(uniform(size, 1, 0)));
    given["weight"] = always(uniform(size, 1, 0.01f));
    for (const float value : filtered(given, 30).values) EXPECT_LE(value, std::pow(0.9, 10) * 1.0001);
}

TEST_F(Spatiotemporal, WhatCountsNothingChangesNothing) {
    FrameImages given = wall(size);
    given["signal"] = switching(5, always(uniform(size, 1, 0.25f)), always(uniform(size, 1, 1)));
    given["weight"] = switching(5, always(uniform(size, 1, 1)), always(uniform(size, 1, 0)));
    for (const float value : filtered(given, 12).values) EXPECT_EQ(value, 0.25f);
}

TEST_F(Spatiotemporal, WhatTheGradientSeesIsGoneAfterTenFrames) {
    FrameImages given = wall(size);
    given["signal"] = switching(20, always(uniform(size, 1, 1)), always(uniform(size, 1, 0)));
    for (const float value : filtered(given, 30, {"filter.gradient=true"}).values) EXPECT_LE(value, 0.02);
    // Through noise: the mean's change from 0.9 to 0.1.
    given["signal"] = switching(20, coins(0.9f), coins(0.1f));
    EXPECT_NEAR(meanOf(filtered(given, 30, {"filter.gradient=true"})), 0.1, 0.02 * 0.8);
    EXPECT_GT(meanOf(filtered(given, 30)), 0.1 + 0.2); // without it the old light is still there
}

TEST_F(Spatiotemporal, NoiseAloneIsNoChange) {
    FrameImages given = wall(size);
    given["signal"] = coins(0.5f);
    GivenRenderer made(graph(given, {"filter.gradient=true"}, {"result", "history_length"}), size);
    for (int i = 0; i < 30; ++i) made.frame();
    EXPECT_GT(meanOf(made.read({"filter", "history_length"})), 9.5);
}

TEST_F(Spatiotemporal, AChangeOfDepthOrNormalDropsTheHistory) {
    Image turned = uniform(size, 4, 0);
    for (size_t i = 0; i < turned.values.size(); i += 4)
        turned.values[i] = turned.values[i + 2] = std::sqrt(0.5f);
    for (const bool byDepth : {true, false}) {
        FrameImages given = wall(size);
        given["signal"] = switching(20, always(uniform(size, 1, 1)), always(uniform(size, 1, 0)));
        if (byDepth)
            given["depth"] =
                switching(20, always(uniform(size, 1, depthAt(2))), always(uniform(size, 1, depthAt(2.1f))));
        else
            given["normal"] = switching(20, always(facing(size)), always(turned));
        for (const float value : filtered(given, 21).values) EXPECT_EQ(value, 0);
    }
}

TEST_F(Spatiotemporal, TheHistoryFollowsMotion) {
    // A pattern that moves two pixels a frame to the right; what enters has no history.
    const auto pattern = [](std::uint32_t frame) {
        Image image = uniform(size, 1, 0);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                image.at(x, y) = noise(x - 2 * static_cast<int>(frame) + 1000, y, 0);
        return image;
    };
    FrameImages given = wall(size);
    given["signal"] = pattern;
    Image motion = uniform(size, 2, 0);
    for (size_t i = 0; i < motion.values.size(); i += 2) motion.values[i] = -2;
    given["motion"] = always(motion);
    GivenRenderer made(graph(given, {"filter.iterations=0"}, {"result", "history_length"}), size);
    for (int i = 0; i < 8; ++i) made.frame();
    EXPECT_LE(difference(made.read(result), pattern(7)).largest, 1e-6);
    const Image length = made.read({"filter", "history_length"});
    for (int x = 0; x < length.width; ++x) EXPECT_EQ(length.at(x, 9), std::min(8, x / 2 + 1)) << x;
}

TEST_F(Spatiotemporal, FollowingDoesNotDependOnWhichWayIsUp) {
    const auto pattern = [](std::uint32_t frame) {
        Image image = uniform(size, 1, 0);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) image.at(x, y) = noise(x, y + static_cast<int>(frame), 0);
        return image; // moves up by one pixel a frame
    };
    FrameImages given = wall(size);
    given["signal"] = pattern;
    Image motion = uniform(size, 2, 0);
    for (size_t i = 1; i < motion.values.size(); i += 2) motion.values[i] = -1; // it came from below
    given["motion"] = always(motion);
    EXPECT_LE(difference(filtered(given, 8, {"filter.iterations=0"}), pattern(7)).largest, 1e-6);
}

TEST_F(Spatiotemporal, TheTimeAverageIsThatOfTheSignal) {
    for (const Settings& variant :
         {Settings{}, Settings{"filter.iterations=0"}, Settings{"filter.iterations=5"},
          Settings{"filter.filtered_history=true"}, Settings{"filter.gradient=true"}})
        for (const float share : {0.1f, 0.5f, 0.9f}) {
            FrameImages given = wall(size);
            given["signal"] = coins(share);
            GivenRenderer made(graph(given, variant), size);
            double out = 0, in = 0;
            const int frames = 60;
            for (int i = 0; i < frames; ++i) {
                made.frame();
                out += meanOf(made.read(result)) / frames;
                in += meanOf(coins(share)(static_cast<std::uint32_t>(i))) / frames;
            }
            EXPECT_NEAR(out, in, 0.01) << share << (variant.empty() ? "" : variant[0]);
        }
}

TEST_F(Spatiotemporal, NoiseFallsAsTheSamplesSay) {
    FrameImages given = wall(size);
    given["signal"] = coins(0.5f);
    const auto noiseOf = [&](const Settings& settings) {
        return difference(filtered(given, 40, settings), uniform(size, 1, 0.5f)).rms;
    };
    // An exponential mean that gives a new frame 1/10 has 1/19 of its variance.
    EXPECT_NEAR(noiseOf({"filter.iterations=0"}), 0.5 / std::sqrt(19.0), 0.01);
    EXPECT_LE(noiseOf({}), 0.5 / std::sqrt(19.0) / 4);
    EXPECT_LE(noiseOf({"filter.filtered_history=true"}), noiseOf({}));
}

TEST_F(Spatiotemporal, TheVarianceIsThatOfTheMean) {
    FrameImages given = wall(size);
    given["signal"] = coins(0.5f);
    for (const int frames : {2, 8}) { // estimated in space, and over time
        GivenRenderer made(graph(given, {}, {"result", "variance"}), size);
        for (int i = 0; i < frames; ++i) made.frame();
        const double expected = frames == 2 ? 4.0 / 2 * 0.25 / 2 : 0.25 / frames;
        EXPECT_NEAR(meanOf(made.read({"filter", "variance"})), expected, 0.1 * expected) << frames;
    }
}

TEST_F(Spatiotemporal, NothingLeaksOverAnEdge) {
    // Left 0 at distance 2, right 1 at distance 2.5; below the wall is turned by 45 degrees, and 0.5.
    Image depth = uniform(size, 1, depthAt(2)), signal = uniform(size, 1, 0), normal = facing(size);
    for (int y = 0; y < signal.height; ++y)
        for (int x = 0; x < signal.width; ++x) {
            if (x >= 24) {
                depth.at(x, y) = depthAt(2.5f);
                signal.at(x, y) = 1;
            }
            if (y >= 16) {
                normal.at(x, y, 1) = normal.at(x, y, 2) = std::sqrt(0.5f);
                signal.at(x, y) = 0.5f;
            }
        }
    FrameImages given = wall(size);
    given["depth"] = always(depth);
    given["normal"] = always(normal);
    // Noise of the signal opens the stop of brightness; the mean is the value.
    given["signal"] = [&](std::uint32_t frame) {
        Image noisy = signal;
        for (int y = 0; y < noisy.height; ++y)
            for (int x = 0; x < noisy.width; ++x) noisy.at(x, y) += noise(x, y, frame) - 0.5f;
        return noisy;
    };
    const Image out = filtered(given, 30);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < out.width; ++x) EXPECT_NEAR(out.at(x, y), signal.at(x, y), 0.1) << x << " " << y;
    double left = 0, right = 0;
    for (int y = 0; y < 16; ++y) {
        left += out.at(23, y) / 16;
        right += out.at(24, y) / 16;
    }
    EXPECT_NEAR(left, 0, 0.02);
    EXPECT_NEAR(right, 1, 0.02);
}

TEST_F(Spatiotemporal, ClampingBoundsWhatIsLeftOfTheOldLight) {
    FrameImages given = wall(size);
    given["signal"] = switching(20, always(uniform(size, 1, 1)), always(uniform(size, 1, 0)));
    for (const float value : filtered(given, 21, {"filter.clamp=1"}).values) EXPECT_EQ(value, 0);
}

TEST_F(Spatiotemporal, ACutAndAPropertyStartAnew) {
    FrameImages given = wall(size);
    given["signal"] = switching(10, always(uniform(size, 1, 1)), always(uniform(size, 1, 0)));
    for (const bool cut : {true, false}) {
        GivenRenderer made(graph(given), size);
        for (int i = 0; i < 10; ++i) made.frame();
        if (cut)
            made.setTime(0.5);
        else
            made.set("filter.sigma_normal=100");
        made.frame();
        for (const float value : made.read(result).values) EXPECT_EQ(value, 0) << cut;
    }
}

TEST_F(Spatiotemporal, DevicesWithFewTexelsReadBlocksAndGiveTheSame) {
    Capabilities few = context().capabilities();
    few.maxTextureBufferTexels = 100;
    for (const Settings& variant : variants)
        for (const char* colours : {"given.colours=1", "given.colours=4"}) {
            FrameImages given = wall(size);
            given["signal"] = coins(0.5f);
            given["motion"] = always(uniform(size, 2, 0.37f));
            Settings settings = variant;
            settings.emplace_back(colours);
            const Graph filter = graph(given, settings, {"result", "variance"});
            GivenRenderer usual(filter, size), other(filter, size, few);
            for (int i = 0; i < 6; ++i) {
                usual.frame();
                other.frame();
            }
            EXPECT_LE(difference(usual.read(result), other.read(result)).largest, 1e-5);
        }
}

TEST_F(Spatiotemporal, SaysWhatItLeavesOut) {
    FrameImages given = wall(size);
    given.erase("motion");
    given["signal"] = coins(0.5f);
    const auto leftOut = [&](const Settings& settings) {
        GivenRenderer made(graph(given, settings), size);
        std::string all;
        for (const LeftOut& left : made.plan().leftOut) all += left.what + ": " + left.why + "\n";
        return all;
    };
    EXPECT_NE(leftOut({}).find("reprojection: no motion is connected"), std::string::npos);
    EXPECT_NE(leftOut({"filter.iterations=0"}).find("spatial filtering"), std::string::npos);
    EXPECT_NE(leftOut({"filter.history=1"}).find("history: one frame is all of it"), std::string::npos);
    // An empty scene: visibility is 1 everywhere, and stays it.
    const Image empty = render(shippedGraph("denoised_ao"), trianglesScene({}), {"denoise", "result"}, 2);
    for (const float value : empty.values) EXPECT_EQ(value, 1);
}

// ---- real scenes

// The graph's visibility replaced by the albedo: what is filtered moves with the surfaces and has no noise.
Graph followedAlbedo(const Settings& settings) {
    Graph graph = shippedGraph("denoised_ao", {"denoise.signal=gbuffer.albedo", "denoise.iterations=0"});
    for (const std::string& setting : settings) applySetting(graph, shipped(), setting);
    std::erase_if(graph.edges, [](const GraphEdge& edge) { return edge.to == PortRef{"denoise", "weight"}; });
    return graph;
}

struct MovingScenes : Spatiotemporal, ::testing::WithParamInterface<const char*> {
    struct Ghost {
        double mean = 0; // difference to this frame's image
        double far = 0;  // share of pixels with a difference above a tenth
    };
    static Ghost ghost(const std::string& scene, const Settings& settings) {
        RenderOptions options;
        options.checkFinite = true;
        options.previews = {{"gbuffer", "albedo"}};
        Renderer made = renderer(followedAlbedo(settings), loadScene(scene), options, {160, 90, 1});
        for (int i = 0; i < 30; ++i) made.frame();
        Ghost found;
        const double pixels = 10.0 * 160 * 90;
        for (int i = 0; i < 10; ++i) {
            made.frame();
            const Image now = made.read({"denoise", "result"}), right = made.read({"gbuffer", "albedo"});
            for (size_t p = 0; p < now.pixelCount(); ++p) {
                double most = 0;
                for (size_t c = 0; c < 3; ++c)
                    most = std::max(
                        most, std::abs(double{now.values[4 * p + c]} - double{right.values[4 * p + c]}));
                found.mean += most / pixels;
                found.far += most > 0.1 ? 1 / pixels : 0;
            }
        }
        return found;
    }
};

TEST_P(MovingScenes, NothingThatMovedLeavesAGhost) {
    // What belongs to the surface: where it was followed rightly, and where the history was dropped, the
    // result is this frame's image but for resampling at edges within a surface.
    const Ghost found = ghost(GetParam(), {});
    const Ghost blind = ghost(GetParam(), {"denoise.depth_tolerance=1000", "denoise.normal_tolerance=180"});
    EXPECT_LE(found.mean, 0.002);
    EXPECT_LE(found.far, 0.002);
    EXPECT_GE(blind.far, 2 * found.far);
}

INSTANTIATE_TEST_SUITE_P(Scenes, MovingScenes,
                         ::testing::Values("builtin:morph?detail=0.1", "builtin:skinned?detail=0.1"));

TEST_F(Spatiotemporal, ScaleAndOddSizesDoNotMatter) {
    RenderOptions options;
    options.checkFinite = true;
    const Graph graph = shippedGraph("denoised_ao", {"denoise.gradient=true", "ao.tracer=bvh.tracer"});
    const auto picture = [&](double scale, Extent extent) {
        Renderer made = renderer(
            graph, transformed("builtin:blob?detail=0.02", glm::scale(glm::dmat4(1), glm::dvec3(scale))),
            options, extent);
        for (int i = 0; i < 6; ++i) made.frame();
        return made.read({"denoise", "result"});
    };
    const Image usual = picture(1, {96, 54, 1});
    for (const double scale : {1e-4, 1e4})
        EXPECT_LE(difference(usual, picture(scale, {96, 54, 1})).rms, 0.02) << scale;
    for (const Extent& extent : {Extent{1, 1, 1}, Extent{1, 7, 1}, Extent{33, 17, 1}})
        for (const float value : picture(1, extent).values) EXPECT_TRUE(value >= 0 && value <= 1);
}

TEST_F(Spatiotemporal, ComesNearerToTheReferenceThanTheMeanOfTheSameFrames) {
    if (shipped().find("ReferenceAmbientOcclusion") == nullptr) GTEST_SKIP() << "Embree is not built in";
    const Scene scene = loadScene("builtin:blob?detail=0.05");
    const Image reference =
        render(shippedGraph("reference_ao", {"reference.samples=256"}), scene, {"reference", "visibility"});
    const Settings bvh = {"ao.tracer=bvh.tracer"};
    const Image raw = render(shippedGraph("ray_ao", bvh), scene, {"mean", "result"}, 10);
    const Image out = render(shippedGraph("denoised_ao", bvh), scene, {"denoise", "result"}, 10);
    EXPECT_LE(difference(reference, out).rms, 0.7 * difference(reference, raw).rms);
}

} // namespace
} // namespace kestrel::test
