// Tone mapping that exposes by the picture itself.
#include "filter_fixture.h"
#include <cmath>
#include <limits>

namespace kestrel::test {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();
const PortRef image{"tone", "image"};

struct ToneMapTest : FilterTest {
    // A ToneMap with these properties, linear and without encoding unless they say otherwise.
    static Graph toneGraph(const FrameImages& given, std::vector<std::string> settings, int channels = 4) {
        GivenImages::given = &given;
        Graph graph;
        graph.name = "test";
        for (const auto& [name, type] :
             {std::pair<std::string, std::string>{"given", "GivenImages"}, {"tone", "ToneMap"}}) {
            GraphPass pass;
            pass.name = name;
            pass.type = type;
            graph.passes.push_back(pass);
        }
        graph.edges.push_back({{"given", "signal"}, {"tone", "colour"}, {}});
        graph.outputs.push_back({image, {}});
        for (const char* plain : {"tone.operator=linear", "tone.encode=false"})
            settings.insert(settings.begin(), plain);
        settings.push_back("given.colours=" + std::to_string(channels));
        for (const std::string& setting : settings) applySetting(graph, registry(), setting);
        return graph;
    }

    struct Exposed : Renderer {
        explicit Exposed(const Graph& graph, Extent extent = size)
            : Renderer(graph, registry(), trianglesScene(square()), context().capabilities(),
                       optionsOf(extent)) {}
        static RenderOptions optionsOf(Extent extent) {
            RenderOptions options;
            options.size = extent;
            return options;
        }
        // Stops, as the stats tell it.
        double exposure() { return frame().values.at("tone").at("exposure"); }
    };

    // Light of many strengths, and some pixels without.
    static Image lights(Extent extent, float scale) {
        Image picture(static_cast<int>(extent.width), static_cast<int>(extent.height), 4, 1);
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x)
                for (int c = 0; c < 3; ++c)
                    picture.at(x, y, c) =
                        (x + y) % 7 == 0
                            ? 0
                            : scale * std::exp2(12 * noise(x, y, static_cast<std::uint32_t>(c)) - 6);
        return picture;
    }
    // Two to the mean of log2 luminance, as ToneMap's sentence defines it.
    static double logAverage(const Image& picture) {
        double sum = 0;
        int count = 0;
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x) {
                const float l = luminance(picture.at(x, y, 0), picture.at(x, y, 1), picture.at(x, y, 2));
                if (!(l > 0) || !std::isfinite(l)) continue;
                sum += std::log2(double{l});
                ++count;
            }
        return std::exp2(sum / count);
    }
};

TEST_F(ToneMapTest, AConstantPictureBecomesTheKey) {
    for (const float value : {0.001f, 0.18f, 1.0f, 700.0f})
        for (const int channels : {1, 4}) {
            const FrameImages given{{"signal", always(uniform(size, channels, value))}};
            Exposed renderer(toneGraph(given, {"tone.auto_exposure=true"}, channels));
            // A ten-thousandth of a stop: logarithms are whole numbers of 1/65536.
            EXPECT_NEAR(renderer.exposure(), std::log2(0.18 / double{value}), 1e-4);
            const Image mapped = renderer.read(image);
            for (int c = 0; c < 3; ++c) EXPECT_EQ(mapped.at(20, 10, c), 46.0f / 255); // 0.18 * 255 = 45.9
            EXPECT_EQ(renderer.last().values.at("tone").at("pixels metered"), size.width * size.height);
        }
    const FrameImages given{{"signal", always(uniform(size, 4, 3))}};
    Exposed renderer(toneGraph(given, {"tone.auto_exposure=true", "tone.key=0.5", "tone.exposure=-1"}));
    renderer.frame();
    EXPECT_EQ(renderer.read(image).at(7, 7), 64.0f / 255); // half of one half
}

TEST_F(ToneMapTest, TakesTheMeanOfTheLogarithms) {
    // Sizes below, at and above what one invocation and one group add up.
    for (const Extent extent : {Extent{1, 1, 1}, {48, 32, 1}, {70, 64, 1}, {65, 131, 1}, {640, 360, 1}}) {
        Image picture = lights(extent, 1);
        picture.at(0, 0, 1) = 1; // at least one
        const FrameImages given{{"signal", always(picture)}};
        Exposed renderer(toneGraph(given, {"tone.auto_exposure=true"}), extent);
        EXPECT_NEAR(renderer.exposure(), std::log2(0.18 / logAverage(picture)), 1e-4)
            << extent.width << 'x' << extent.height;
    }
}

TEST_F(ToneMapTest, LightOfAnyStrengthGivesTheSamePicture) {
    for (const char* curve : {"linear", "reinhard", "aces"}) {
        Image first;
        for (const float scale : {1.0f, 4096.0f, 1.0f / 4096}) {
            const FrameImages given{{"signal", always(lights(size, scale))}};
            Exposed renderer(toneGraph(given, {"tone.auto_exposure=true", "tone.encode=true",
                                               std::string("tone.operator=") + curve}));
            renderer.frame();
            const Image mapped = renderer.read(image);
            if (first.empty()) first = mapped;
            // Powers of two scale floats without rounding, and the exposure's whole stops are exact.
            EXPECT_EQ(mapped, first) << curve << ' ' << scale;
        }
    }
}

TEST_F(ToneMapTest, OffIsWhatItWas) {
    const FrameImages given{{"signal", always(lights(size, 1))}};
    Exposed fixed(toneGraph(given, {"tone.exposure=1", "tone.operator=aces", "tone.encode=true"}));
    const FrameRecord& record = fixed.frame();
    EXPECT_FALSE(record.values.contains("tone"));
    EXPECT_EQ(fixed.plan().passes.back().stepCount, 1);
    // The same picture where the measured exposure is that one: no other arithmetic.
    const double key = logAverage(lights(size, 1));
    Exposed metered(toneGraph(given, {"tone.auto_exposure=true", fmt::format("tone.key={}", key / 64),
                                      "tone.exposure=7", "tone.operator=aces", "tone.encode=true"}));
    EXPECT_NEAR(metered.exposure(), 1, 1e-4);
    const Image a = fixed.read(image), b = metered.read(image);
    for (size_t i = 0; i < a.values.size(); ++i) ASSERT_NEAR(a.values[i], b.values[i], 1.01f / 255);
}

TEST_F(ToneMapTest, BlackAndStrangePixelsDoNotCount) {
    Image picture(48, 32, 4, 0.5f);
    int strange = 0;
    const auto put = [&](int x, int y, const glm::vec3& value) {
        for (int c = 0; c < 3; ++c) picture.at(x, y, c) = value[c];
        ++strange;
    };
    put(0, 0, {infinity, 1, 1});
    put(1, 0, {1, nan, 1});
    put(2, 0, {1, 1, -infinity});
    put(3, 0, {0, 0, 0});
    put(4, 0, {-1, -2, -3});
    put(5, 0, {1e-35f, 0, 0});
    const FrameImages given{{"signal", always(picture)}};
    Exposed renderer(toneGraph(given, {"tone.auto_exposure=true"}));
    EXPECT_NEAR(renderer.exposure(), std::log2(0.18 / 0.5), 1e-4);
    EXPECT_EQ(renderer.last().values.at("tone").at("pixels metered"), 48 * 32 - strange);

    // Nothing to see at all: light stays as it is, and black stays black.
    for (const float value : {0.0f, infinity, nan}) {
        const FrameImages nothing{{"signal", always(uniform(size, 4, value))}};
        Exposed dark(toneGraph(nothing, {"tone.auto_exposure=true"}));
        EXPECT_NEAR(dark.exposure(), 0, 1e-5);
        if (value == 0) {
            EXPECT_EQ(dark.read(image).at(3, 3), 0);
        }
    }
    // As bright as floats go, and as dim as counts.
    for (const float value : {1e37f, 1e-29f}) {
        const FrameImages extreme{{"signal", always(uniform(size, 4, value))}};
        Exposed renderer2(toneGraph(extreme, {"tone.auto_exposure=true", "tone.exposure=1"}));
        EXPECT_TRUE(std::isfinite(renderer2.exposure()));
    }
}

TEST_F(ToneMapTest, FollowsChangesOfLightWithoutFlicker) {
    // Light that changes by 6 stops at frame 4, and flickers a little before.
    const FrameImages given{{"signal", [](std::uint32_t index) {
                                 const float flicker = index % 2 == 0 ? 1.0f : 1.5f;
                                 return uniform(size, 4, index < 4 ? flicker : 64.0f);
                             }}};
    Exposed renderer(toneGraph(given, {"tone.auto_exposure=true", "tone.adaptation=8"}));
    const double rate = 1 - std::exp(-1.0 / 8);
    double expected = std::log2(0.18); // at once in the first frame
    for (int frame = 0; frame < 20; ++frame) {
        const double measured = std::log2(0.18 / (frame >= 4 ? 64 : frame % 2 == 0 ? 1 : 1.5));
        if (frame > 0) expected += (measured - expected) * rate;
        EXPECT_NEAR(renderer.exposure(), expected, 1e-3) << frame;
    }
    // At once again after a cut: other properties are one; and without adaptation always.
    renderer.set("tone.key=0.36");
    EXPECT_NEAR(renderer.exposure(), std::log2(0.36 / 64), 1e-4);
    Exposed hasty(toneGraph(given, {"tone.auto_exposure=true", "tone.adaptation=0"}));
    for (int frame = 0; frame < 6; ++frame)
        EXPECT_NEAR(hasty.exposure(), std::log2(0.18 / (frame >= 4 ? 64 : frame % 2 == 0 ? 1 : 1.5)), 1e-4);
}

TEST_F(ToneMapTest, KeepsItsExposureThroughBlackFrames) {
    const FrameImages given{
        {"signal", [](std::uint32_t index) { return uniform(size, 4, index == 1 ? 0.0f : 2.0f); }}};
    Exposed renderer(toneGraph(given, {"tone.auto_exposure=true"}));
    const double first = renderer.exposure();
    EXPECT_EQ(renderer.exposure(), first);
    EXPECT_EQ(renderer.last().values.at("tone").at("pixels metered"), 0);
    EXPECT_NEAR(renderer.exposure(), first, 1e-5);
    // Light after black is taken at once.
    const FrameImages opening{
        {"signal", [](std::uint32_t index) { return uniform(size, 4, index == 0 ? 0.0f : 2.0f); }}};
    Exposed late(toneGraph(opening, {"tone.auto_exposure=true"}));
    late.frame();
    EXPECT_NEAR(late.exposure(), std::log2(0.09), 1e-4);
}

} // namespace
} // namespace kestrel::test
