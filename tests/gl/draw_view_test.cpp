// lib/view.glsl against what is really rasterized.
#include "draw/draw_calls.h"
#include "draw/view_data.h"
#include "gl_fixture.h"
#include "graph/pass.h"
#include "support/folders.h"
#include <glm/gtc/matrix_transform.hpp>

namespace kestrel {
namespace {

class DrawViewTest : public test::GlTest {};

CameraState cameraOf(bool orthographic, float scale) {
    CameraState camera;
    camera.position = scale * glm::vec3(1, 2, 5);
    camera.view = glm::lookAt(camera.position, glm::vec3(0), glm::vec3(0, 1, 0));
    camera.orthographic = orthographic;
    camera.halfHeight = 2 * scale;
    camera.nearPlane = scale;
    camera.farPlane = orthographic ? 20 * scale : 0;
    return camera;
}

TEST_F(DrawViewTest, ADepthLeadsBackToThePositionThatWasDrawn) {
    // A triangle in the plane y = 0 that covers the whole image; its positions are known from where rays meet
    // the plane.
    const std::string vertex = "layout(std140) uniform DepthView { ViewData view; };\n"
                               "uniform float scale;\n"
                               "out vec3 drawn;\n"
                               "void main() {\n"
                               "    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 8.0 - 2.0;\n"
                               "    drawn = scale * vec3(corner.x, 0.0, 2.0 - corner.y);\n"
                               "    gl_Position = view.projection * (view.view * vec4(drawn, 1.0));\n"
                               "}\n";
    const std::string fragment =
        "layout(std140) uniform DepthView { ViewData view; };\n"
        "in vec3 drawn;\n"
        "out vec4 out_position; out vec4 out_ray; out vec4 out_pixel;\n"
        "void main() {\n"
        "    vec3 back = positionFromDepth(view, gl_FragCoord.xy, gl_FragCoord.z);\n"
        "    vec3 origin, direction; float tNear, tFar;\n"
        "    cameraRay(view, gl_FragCoord.xy, origin, direction, tNear, tFar);\n"
        "    float t = -origin.y / direction.y;\n"
        "    vec2 pixel; float depth;\n"
        "    bool before = project(view, drawn, pixel, depth);\n"
        "    out_position = vec4(back - drawn, viewDepth(view, gl_FragCoord.z) + (view.view * vec4(drawn, "
        "1.0)).z);\n"
        "    out_ray = vec4(origin + t * direction - drawn, t > tNear && t < tFar ? 1.0 : 0.0);\n"
        "    out_pixel = vec4(pixel - gl_FragCoord.xy, before ? 1.0 : 0.0, 1.0);\n"
        "}\n";
    const std::string include = "#include \"lib/view.glsl\"\n";
    const gl::Program program(
        test::composeTexts({{"t.vert", include + vertex}, {"t.frag", include + fragment}}),
        {"position", "ray", "pixel"}, test::context().capabilities());
    gl::VertexArray none("none");
    for (const float scale : {1e-4F, 1.0F, 1e4F}) {
        for (const bool orthographic : {false, true}) {
            SCOPED_TRACE(::testing::Message() << scale << (orthographic ? " orthographic" : " perspective"));
            World world;
            world.size = {61, 33, 1};
            const View chosen{.divisor = 2, .guard = 6, .jitter = true};
            const CameraState camera = cameraOf(orthographic, scale);
            const Extent extent = world.extentOf(chosen);
            const ViewData view = viewData(chosen, extent, ViewFrame{world.size, 9, camera, camera});
            gl::Buffer block(sizeof view, "view");
            block.upload(std::as_bytes(std::span(&view, 1)));
            const Desc desc = Desc::texture2D(Format::RGBA32F, extent);
            gl::Texture position(desc, "position"), ray(desc, "ray"), pixel(desc, "pixel");
            gl::FramebufferCache framebuffers;
            glBindFramebuffer(GL_FRAMEBUFFER, framebuffers.get({{&position}, {&ray}, {&pixel}}, {}, {}));
            setViewport({extent.width, extent.height});
            program.use();
            glProgramUniform1f(program.name(), program.uniform("scale"), scale);
            glBindBufferBase(GL_UNIFORM_BUFFER, program.slot("DepthView")->unit, block.name());
            drawVertices(DrawState::overwrite(), none, 3);
            const Image positions = position.downloadImage(), rays = ray.downloadImage(),
                        pixels = pixel.downloadImage();
            int covered = 0;
            for (int y = 0; y < pixels.height; ++y) {
                for (int x = 0; x < pixels.width; ++x) {
                    if (pixels.at(x, y, 3) == 0) continue;
                    ++covered;
                    for (int c = 0; c < 3; ++c) {
                        EXPECT_NEAR(positions.at(x, y, c), 0, 1e-4F * scale);
                        EXPECT_NEAR(rays.at(x, y, c), 0, 1e-4F * scale);
                    }
                    EXPECT_NEAR(positions.at(x, y, 3), 0, 1e-4F * scale);
                    EXPECT_EQ(rays.at(x, y, 3), 1);
                    EXPECT_NEAR(pixels.at(x, y, 0), 0, 5e-3F);
                    EXPECT_NEAR(pixels.at(x, y, 1), 0, 5e-3F);
                    EXPECT_EQ(pixels.at(x, y, 2), 1);
                }
            }
            EXPECT_GT(covered, 100);
        }
    }
}

TEST_F(DrawViewTest, TheShippedFullscreenTriangleCoversEveryPixel) {
    ShaderLibrary library({test::sourceFolder() / "shaders"});
    library.addVirtual("t.frag", "out vec4 out_colour;\nvoid main() { out_colour = vec4(1.0); }\n");
    const gl::Program program(compose({{"lib/fullscreen.vert", "t.frag"}, {}, {}}, library), {"colour"},
                              test::context().capabilities());
    gl::Texture colour(Desc::texture2D(Format::R8, {7, 5, 1}), "colour");
    gl::FramebufferCache framebuffers;
    gl::VertexArray none("none");
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffers.get({{&colour}}, {}, {}));
    setViewport({7, 5});
    program.use();
    drawFullscreen(DrawState::overwrite(), none);
    EXPECT_EQ(test::as<std::uint8_t>(colour.download()), std::vector<std::uint8_t>(35, 255));
}

} // namespace
} // namespace kestrel
