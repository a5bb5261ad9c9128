#include "core/error.h"
#include "gl/requirements.h"
#include "gl/timer.h"
#include "gl_fixture.h"
#include <cstdio>
#include <cstdlib>
#include <gmock/gmock.h>

namespace kestrel {
namespace {

using test::messageOf;
using ::testing::Contains;
using ::testing::HasSubstr;

// In a process of its own, since a driver reads its environment once: makes a context, prints what came of
// it and exits as the command line would.
[[noreturn]] void createAndExit(gl::Backend backend) {
    try {
        gl::ContextOptions options;
        options.backend = backend;
        const auto made = gl::Context::create(options);
        std::fprintf(stderr, "made %s", made->driver().c_str());
        std::_Exit(0);
    } catch (const Error& error) {
        std::fprintf(stderr, "%s", error.what());
        std::_Exit(static_cast<int>(error.status()));
    }
}

class ContextDeathTest : public ::testing::Test {
protected:
    void SetUp() override { ::testing::FLAGS_gtest_death_test_style = "threadsafe"; }
};

TEST(Backend, IsKnownByName) {
    EXPECT_EQ(gl::backendFromName("egl"), gl::Backend::Egl);
    EXPECT_EQ(gl::backendFromName("osmesa"), gl::Backend::OsMesa);
    EXPECT_EQ(gl::backendFromName("window"), gl::Backend::Window);
    EXPECT_EQ(messageOf<InputError>([] { gl::backendFromName("osmsea"); }),
              "unknown backend 'osmsea' (did you mean 'osmesa'?); there are egl, osmesa and window");
}

TEST(Requirements, NameEveryMissingExtension) {
    std::set<std::string> listed;
    for (const std::string& extension : gl::missingExtensions({})) listed.insert(extension);
    EXPECT_THAT(listed, Contains("GL_ARB_gl_spirv"));
    EXPECT_THAT(listed, Contains("GL_KHR_no_error"));
    EXPECT_NO_THROW(gl::requireOpenGl46("4.6 (Core Profile) Mesa 22.3.6", "llvmpipe", listed));
    listed.erase("GL_ARB_polygon_offset_clamp");
    listed.erase("GL_ARB_clip_control");
    EXPECT_EQ(messageOf<MachineError>(
                  [&] { gl::requireOpenGl46("4.6 (Core Profile) Mesa 22.3.6", "softpipe", listed); }),
              "'softpipe' lacks what OpenGL 4.6 needs: GL_ARB_clip_control, GL_ARB_polygon_offset_clamp");
}

TEST(Requirements, TrustAVersionThatIsNotMesas) {
    EXPECT_NO_THROW(gl::requireOpenGl46("4.6.0 NVIDIA 535.54", "some GPU", {}));
}

TEST(Requirements, RefuseAnOlderVersion) {
    for (const char* version : {"4.5 (Core Profile) Mesa 22.3.6", "3.3", "", "4"})
        EXPECT_THAT(messageOf<MachineError>([&] { gl::requireOpenGl46(version, "some GPU", {}); }),
                    HasSubstr("Kestrel needs 4.6"))
            << version;
}

TEST(Requirements, OverrideKeepsTheUsersChoice) {
    setenv("MESA_GL_VERSION_OVERRIDE", "4.7", 1);
    unsetenv("MESA_GLSL_VERSION_OVERRIDE");
    gl::overrideVersion();
    EXPECT_STREQ(std::getenv("MESA_GL_VERSION_OVERRIDE"), "4.7");
    EXPECT_STREQ(std::getenv("MESA_GLSL_VERSION_OVERRIDE"), "460");
    unsetenv("MESA_GL_VERSION_OVERRIDE");
}

TEST(Context, EglGivesOpenGl46WithItsCapabilities) {
    const Capabilities& capabilities = test::context().capabilities();
    EXPECT_THAT(capabilities.version, HasSubstr("4.6"));
    EXPECT_FALSE(capabilities.renderer.empty());
    EXPECT_TRUE(capabilities.has("GL_ARB_gl_spirv") ||
                capabilities.version.find("Mesa") == std::string::npos);
    EXPECT_GE(capabilities.maxComputeImages, 8);
    EXPECT_GE(capabilities.maxStorageBlocks, 8);
    EXPECT_GE(capabilities.maxTextureUnits, 16);
    EXPECT_GE(capabilities.maxTextureSize, 16384);
    EXPECT_GE(capabilities.maxStorageBlockBytes, std::int64_t{1} << 27);
    EXPECT_EQ(capabilities.software, capabilities.renderer.find("llvmpipe") != std::string::npos);
    GLfloat clearDepth = 1;
    glGetFloatv(GL_DEPTH_CLEAR_VALUE, &clearDepth);
    EXPECT_EQ(clearDepth, 0);
    GLint depthMode = 0;
    glGetIntegerv(GL_CLIP_DEPTH_MODE, &depthMode);
    EXPECT_EQ(depthMode, GL_ZERO_TO_ONE);
}

TEST(Context, OsMesaStandsBesideEgl) {
    gl::Context& egl = test::context();
    gl::ContextOptions options;
    options.backend = gl::Backend::OsMesa;
    std::unique_ptr<gl::Context> osmesa;
    try {
        osmesa = gl::Context::create(options);
    } catch (const MachineError& error) {
        GTEST_SKIP() << error.what();
    }
    EXPECT_THAT(osmesa->capabilities().version, HasSubstr("4.6"));
    // Both give out the same first names; what stands behind them is each context's own.
    const auto bufferOf = [](gl::Context& context, std::uint32_t word) {
        context.makeCurrent();
        gl::Buffer buffer(16, "own");
        buffer.clear(word);
        return buffer;
    };
    const auto wordOf = [](gl::Context& context, const gl::Buffer& buffer) {
        context.makeCurrent();
        return test::as<std::uint32_t>(buffer.download())[3];
    };
    gl::Buffer inEgl = bufferOf(egl, 7);
    gl::Buffer inOsMesa = bufferOf(*osmesa, 8);
    for (int turn = 0; turn < 2; ++turn) {
        EXPECT_EQ(wordOf(egl, inEgl), 7U);
        EXPECT_EQ(wordOf(*osmesa, inOsMesa), 8U);
    }
    inOsMesa = gl::Buffer();
    osmesa.reset();
    EXPECT_EQ(wordOf(egl, inEgl), 7U); // still there, and current again
}

TEST(Context, CountsSevereErrors) {
    test::context();
    const std::uint64_t before = gl::Context::severeErrors();
    glBindTextureUnit(0, 4711); // no such texture
    EXPECT_EQ(gl::Context::severeErrors(), before + 1);
    glBindTextureUnit(0, 0);
    EXPECT_EQ(gl::Context::severeErrors(), before + 1);
}

TEST_F(ContextDeathTest, ARendererWithoutAll46ExtensionsIsNamed) {
    EXPECT_EXIT(
        {
            setenv("GALLIUM_DRIVER", "softpipe", 1);
            createAndExit(gl::Backend::Egl);
        },
        ::testing::ExitedWithCode(3), "'softpipe' lacks what OpenGL 4.6 needs: .*GL_ARB_gl_spirv");
}

TEST_F(ContextDeathTest, TheUsersOverrideIsKeptAndRefused) {
    EXPECT_EXIT(
        {
            setenv("MESA_GL_VERSION_OVERRIDE", "4.5", 1);
            createAndExit(gl::Backend::Egl);
        },
        ::testing::ExitedWithCode(3), "OpenGL 4.6");
}

TEST_F(ContextDeathTest, OsMesaWithTooLowAVersionSaysSo) {
    EXPECT_EXIT(
        {
            setenv("MESA_GL_VERSION_OVERRIDE", "4.5", 1);
            createAndExit(gl::Backend::OsMesa);
        },
        ::testing::ExitedWithCode(3), "OSMesa");
}

TEST(Context, AWindowHasAFramebufferAndStaysOpen) {
    gl::ContextOptions options;
    options.backend = gl::Backend::Window;
    options.windowSize = {320, 200, 1};
    std::unique_ptr<gl::Context> window;
    try {
        window = gl::Context::create(options);
    } catch (const MachineError& error) {
        GTEST_SKIP() << error.what();
    }
    EXPECT_THAT(window->capabilities().version, HasSubstr("4.6"));
    EXPECT_EQ(window->framebufferExtent(), options.windowSize);
    EXPECT_NE(window->window(), nullptr);
    EXPECT_TRUE(window->present());
    gl::Buffer buffer(16, "in the window's context");
    buffer.clear(5);
    EXPECT_EQ(test::as<std::uint32_t>(buffer.download())[0], 5U);
}

TEST_F(ContextDeathTest, AWindowNeedsAWindowSystem) {
    EXPECT_EXIT(
        {
            unsetenv("DISPLAY");
            unsetenv("WAYLAND_DISPLAY");
            createAndExit(gl::Backend::Window);
        },
        ::testing::ExitedWithCode(3), "--backend egl");
}

TEST(StepClock, ChoosesByTheRendererAndStatesIt) {
    Capabilities capabilities;
    capabilities.software = true;
    EXPECT_EQ(gl::StepClock(capabilities).name(), "finish");
    capabilities.software = false;
    EXPECT_EQ(gl::StepClock(capabilities).name(), "timer query");
}

TEST(StepClock, BothKindsGiveASampleAStep) {
    test::context();
    for (const auto kind : {gl::StepClock::Kind::Finish, gl::StepClock::Kind::TimerQuery}) {
        gl::StepClock clock(kind);
        std::vector<gl::StepClock::Sample> samples;
        for (std::uint64_t frame = 0; frame < 3; ++frame) {
            clock.beginFrame(frame);
            for (std::uint32_t step = 5; step < 7; ++step) {
                clock.begin(step);
                clock.end();
            }
            const auto known = clock.take();
            samples.insert(samples.end(), known.begin(), known.end());
        }
        const auto rest = clock.take(true);
        samples.insert(samples.end(), rest.begin(), rest.end());
        ASSERT_EQ(samples.size(), 6U);
        for (size_t i = 0; i < samples.size(); ++i) {
            EXPECT_EQ(samples[i].frame, i / 2);
            EXPECT_EQ(samples[i].step, 5 + i % 2);
            EXPECT_GE(samples[i].ms, 0);
        }
    }
}

} // namespace
} // namespace kestrel
