// Depths and normals that a test gives, as a pass, seen by a camera that looks along -z from the origin.
#pragma once
#include "execute/commands.h"
#include "shipped_fixture.h"
#include <functional>
#include <glm/gtc/packing.hpp>

namespace kestrel::test {

// Outputs what the functions give. Pixels count from the lower left corner of the frame, and may lie in the
// guard band.
struct DepthSource final : Pass {
    static inline std::function<float(int x, int y)> depth, second;
    static inline std::function<glm::vec3(int x, int y)> normal; // eye space

    static PassType type() {
        return Describe<DepthSource>("DepthSource", "Depths of a test")
            .output("view_depth", PortKind::Texture, "As given")
            .output("second_depth", PortKind::Texture, "As given")
            .output("normal", PortKind::Texture, "As given")
            .number("guard", &DepthSource::guard, 0, 512, "pixels", "Guard band");
    }
    [[nodiscard]] Declaration declare(const World& world, const Inputs&,
                                      const Demand& demand) const override {
        Declaration declaration;
        const View view{.guard = guard};
        Step step{.name = "give"};
        for (const char* port : {"view_depth", "second_depth", "normal"}) {
            if (!demand.reads(port)) continue;
            const Format format = std::string_view(port) == "normal" ? Format::RGBA16F : Format::R32F;
            declaration.outputs.push_back(
                {.port = port, .desc = Desc::texture2D(format, world.extentOf(view), view)});
            step.uses.push_back({.port = port, .access = Access::Copy, .write = true});
        }
        declaration.steps.push_back(std::move(step));
        declaration.depends = Causes::Frame;
        return declaration;
    }
    void execute(const Step& step, Commands& commands) override {
        for (const Use& use : step.uses) {
            const Extent extent = commands.desc(use.port).extent;
            const int width = static_cast<int>(extent.width), height = static_cast<int>(extent.height);
            Image image(width, height, use.port == "normal" ? 4 : 1);
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    const int up = height - 1 - y - guard, right = x - guard;
                    if (use.port == "normal")
                        for (int k = 0; k < 3; ++k) image.at(x, y, k) = normal(right, up)[k];
                    else
                        image.at(x, y) = use.port == "view_depth" ? depth(right, up) : second(right, up);
                }
            commands.uploadImage(use.port, image);
        }
    }
    int guard = 0;
};

struct DepthTest : ShippedTest {
    static const Registry& registry() {
        static const Registry instance = [] {
            Registry made = shipped();
            made.add(DepthSource::type());
            return made;
        }();
        return instance;
    }
    // Pixels per unit of xy at depth 1: a field of view that belongs to the frame's height.
    static constexpr float pixelsPerUnit = 60;
    static CameraState straightCamera(const Extent& size) {
        CameraState camera;
        camera.nearPlane = 0.01f;
        camera.farPlane = 0;
        camera.verticalFov = 2 * std::atan(0.5f * static_cast<float>(size.height) / pixelsPerUnit);
        return camera;
    }
    struct GivenRenderer : Renderer {
        GivenRenderer(const Graph& graph, const Extent& size)
            : Renderer(graph, registry(), trianglesScene(square()), context().capabilities(), options(size)) {
            setFreeCamera(straightCamera(size));
        }
        static RenderOptions options(const Extent& size) {
            RenderOptions made;
            made.size = size;
            made.checkFinite = true;
            return made;
        }
    };
    // Of a whole-number texture, (x, y) from the lower left corner.
    template<class T>
    struct Texels {
        std::vector<T> values;
        int width = 0;
        [[nodiscard]] T at(int x, int y) const { return values.at(static_cast<size_t>(y * width + x)); }
    };
    template<class T>
    static Texels<T> texels(Renderer& made, const PortRef& port) {
        return {as<T>(made.readBytes(port)), static_cast<int>(made.desc(port).extent.width)};
    }
};

} // namespace kestrel::test
