// Views that are not the frame's: cameras of the scene, faces of a cube, and their motion.
#include "execute_fixture.h"
#include <glm/gtc/matrix_transform.hpp>

namespace kestrel::test {
namespace {

constexpr double pi = 3.14159265358979;

// Triangles on all sides of the point (0.3, 0.2, -0.1), and two cameras; the second one moves.
Scene surroundings() {
    Scene scene;
    scene.name = "surroundings";
    Primitive primitive;
    for (int i = 0; i < 150; ++i) {
        // Points of a spiral over the sphere.
        const double z = 1 - (2 * i + 1) / 150.0, turn = i * pi * (3 - std::sqrt(5.0)),
                     r = std::sqrt(1 - z * z);
        const glm::dvec3 out(r * std::cos(turn), r * std::sin(turn), z);
        const glm::dvec3 side = glm::normalize(glm::cross(out, glm::dvec3(0.3, 1, 0.2)));
        const glm::vec3 middle(out * (2 + 0.5 * (i % 3)));
        const glm::vec3 x(0.25 * side), y(0.25 * glm::cross(out, side));
        for (const glm::vec3& corner : {middle - x - y, middle + x - y, middle + y}) {
            primitive.indices.push_back(static_cast<std::uint32_t>(primitive.positions.size()));
            primitive.positions.push_back(corner);
        }
    }
    primitive.material = 0;
    Material material;
    material.doubleSided = true;
    scene.materials.push_back(material);
    scene.meshes.push_back({"triangles", {primitive}, {}});
    Node mesh;
    mesh.mesh = 0;
    scene.nodes = {mesh};
    for (const char* name : {"still", "moving"}) {
        Camera camera;
        camera.name = name;
        camera.farPlane = 0;
        camera.node = static_cast<int>(scene.nodes.size());
        Node node;
        node.camera = static_cast<int>(scene.cameras.size());
        node.translation = {0.2 * node.camera, 0.1, 0.3};
        scene.cameras.push_back(camera);
        scene.nodes.push_back(node);
    }
    scene.roots = {0, 1, 2};
    AnimationChannel slide;
    slide.node = 2;
    slide.times = {0, 1};
    slide.values = {0.2f, 0.1f, 0.3f, 1.2f, 0.1f, 0.3f};
    scene.animations.push_back({"slide", {slide}});
    finishScene(scene);
    return scene;
}

struct ViewTest : ExecuteTest {
    void SetUp() override {
        ExecuteTest::SetUp();
        shader("see.vert", R"(#include "lib/vertex.glsl"
            #include "shared/view.h"
            layout(std140) uniform ResultView { ViewData result_view; };
            out vec3 position;
            void main() {
                position = in_position;
                gl_Position = result_view.viewProjection * vec4(in_position, 1.0);
            })");
        // Where the surface stands, and how far its pixel moved since the last frame.
        shader("see.frag", R"(#include "lib/last_view.glsl"
            layout(std140) uniform ResultView { ViewData result_view; };
            in vec3 position;
            out vec4 out_result;
            out vec4 out_motion;
            void main() {
                vec2 before;
                projectPrevious(result_view, position, before);
                out_result = vec4(position, 1.0);
                out_motion = vec4(before - gl_FragCoord.xy, 0.0, 1.0);
            })");
    }
    // A pass that draws the scene as the view sees it; `depends` besides what the view itself asks for.
    void addSee(const std::string& type, const View& view, Causes depends = Causes::None) {
        addType(
            type, {"out result", "out motion", "own depth"},
            [view, depends](const FunctionPass&, const World& world, const Inputs&) {
                const Extent extent = world.extentOf(view);
                Declaration declaration;
                for (const char* port : {"result", "motion"})
                    declaration.outputs.push_back({.port = port,
                                                   .desc = Desc::texture2D(Format::RGBA32F, extent, view),
                                                   .clear = glm::vec4(0)});
                declaration.outputs.push_back({.port = "depth",
                                               .desc = Desc::texture2D(Format::D32F, extent, view),
                                               .clear = glm::vec4(0)});
                declaration.depends = depends;
                declaration.steps = {
                    stepOf("draw", {"see.vert", "see.frag"},
                           {write("result", Access::Attachment), write("motion", Access::Attachment),
                            write("depth", Access::Attachment)})};
                return declaration;
            },
            [this](FunctionPass& pass, const Step&, Commands& commands) {
                ++runs_[pass.name];
                commands.drawScene({}, {TriangleClass::Opaque, TriangleClass::OpaqueDoubleSided});
            });
    }
    std::unique_ptr<Renderer> see(const std::string& type, const std::string& camera,
                                  Extent size = {40, 30, 1}) {
        RenderOptions options;
        options.size = size;
        options.camera = camera;
        return rendererOf(graphOf({"see: " + type}, {}, {"see.result", "see.motion"}), options,
                          surroundings());
    }
};

TEST_F(ViewTest, ACameraOfTheSceneSeesWhatTheFrameSeesWithIt) {
    addSee("Frame", {}, Causes::Camera | Causes::Cut);
    addSee("Second", {.source = CameraView{.camera = 1}});
    addSee("Named", {.source = CameraView{.name = "moving"}});
    const auto chosen = see("Frame", "moving");
    for (int i = 0; i < 3; ++i) chosen->frame();
    const Image truth = chosen->read({"see", "result"}), motion = chosen->read({"see", "motion"});
    // The camera moves a sixtieth of a unit a frame: about a third of a pixel at the triangles' distance.
    float largest = 0;
    for (size_t i = 0; i < motion.pixelCount(); ++i)
        largest = std::max(largest, std::abs(motion.values[4 * i]));
    EXPECT_GT(largest, 0.1f);
    EXPECT_LT(largest, 1);
    for (const char* type : {"Second", "Named"}) {
        const auto made = see(type, "still");
        for (int i = 0; i < 3; ++i) made->frame();
        EXPECT_EQ(made->read({"see", "result"}).values, truth.values) << type;
        EXPECT_EQ(made->read({"see", "motion"}).values, motion.values) << type;
    }
}

TEST_F(ViewTest, AViewRunsWhenWhatItLooksFromMoves) {
    addSee("Frame", {}, Causes::Camera | Causes::Cut);
    addSee("First", {.source = CameraView{.camera = 0}});
    addSee("Eye", {.source = CubeView{.face = 1}});
    addSee("Place", {.source = CubeView{.face = 1, .point = glm::vec3(0)}});
    const auto runsOf = [&](const std::string& type, const std::string& camera) {
        runs_.clear();
        const auto made = see(type, camera);
        for (int i = 0; i < 3; ++i) made->frame();
        return runs_["see"];
    };
    EXPECT_EQ(runsOf("Frame", "still"), 1);
    EXPECT_EQ(runsOf("First", "still"), 3) << "some camera moves";
    EXPECT_EQ(runsOf("Eye", "still"), 1);
    EXPECT_EQ(runsOf("Eye", "moving"), 3);
    EXPECT_EQ(runsOf("Place", "still"), 1);
}

TEST_F(ViewTest, SixFacesSeeWhatFramesInTheirDirectionsSee) {
    const glm::vec3 eye(0.3f, 0.2f, -0.1f);
    const glm::vec3 ahead[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    const glm::vec3 up[] = {{0, 1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}, {0, 1, 0}, {0, 1, 0}};
    addSee("Frame", {}, Causes::Camera | Causes::Cut);
    std::set<std::array<float, 3>> seen;
    for (int face = 0; face < 6; ++face) {
        SCOPED_TRACE(face);
        const std::string number = std::to_string(face);
        addSee("Eye" + number,
               {.source = CubeView{.face = face, .nearPlane = 0.05f, .farPlane = 20, .side = 32}});
        addSee(
            "Place" + number,
            {.source = CubeView{.face = face, .point = eye, .nearPlane = 0.05f, .farPlane = 20, .side = 32}});
        CameraState camera;
        camera.position = eye;
        camera.view = glm::lookAt(eye, eye + ahead[face], up[face]);
        camera.verticalFov = static_cast<float>(pi / 2);
        camera.nearPlane = 0.05f;
        camera.farPlane = 20;
        const auto frame = see("Frame", "still", {32, 32, 1});
        frame->setFreeCamera(camera);
        frame->frame();
        const Image truth = frame->read({"see", "result"});
        int covered = 0;
        for (size_t i = 0; i < truth.pixelCount(); ++i) covered += truth.values[4 * i + 3] > 0 ? 1 : 0;
        EXPECT_GT(covered, 50);
        for (const std::string& type : {"Eye" + number, "Place" + number}) {
            const auto made = see(type, "still"); // a frame that is not square
            CameraState elsewhere = camera;
            elsewhere.view = glm::lookAt(eye, glm::vec3(2, 1, 1), glm::vec3(0, 1, 0));
            made->setFreeCamera(elsewhere);
            made->frame();
            const Image image = made->read({"see", "result"});
            ASSERT_EQ(image.sizeText(), truth.sizeText());
            int other = 0; // pixels at edges, where rounding decides
            for (size_t i = 0; i < truth.values.size(); ++i)
                other += std::abs(image.values[i] - truth.values[i]) > 1e-3f ? 1 : 0;
            EXPECT_LE(other, 8) << type;
        }
    }
}

TEST_F(ViewTest, WhatTheSceneHasNotIsRefused) {
    addSee("Tenth", {.source = CameraView{.camera = 9}});
    addSee("Misnamed", {.source = CameraView{.name = "movin"}});
    addSee("Light", {.source = LightView{.light = 0}});
    addSee("Seventh", {.source = CubeView{.face = 6}});
    const auto refusal = [&](const std::string& type) { return messageOf([&] { see(type, "still"); }); };
    EXPECT_NE(refusal("Tenth").find("is seen by camera 9; the scene has 2"), std::string::npos)
        << refusal("Tenth");
    EXPECT_NE(refusal("Misnamed").find("camera 'movin', which the scene has not (did you mean 'moving'?)"),
              std::string::npos)
        << refusal("Misnamed");
    EXPECT_NE(refusal("Light").find("is seen by light 0; the scene has 0"), std::string::npos);
    EXPECT_NE(refusal("Seventh").find("face 6 of a cube, which has 0 to 5"), std::string::npos);
}

} // namespace
} // namespace kestrel::test
