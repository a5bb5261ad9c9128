// Blended surfaces in order: closed forms, Embree's order, and what each giver of layers loses.
#include "support/assets.h"
#include "support/message.h"
#include "transparency_fixture.h"
#include <gmock/gmock.h>
#include <random>

namespace kestrel::test {
namespace {

using Composite = TransparencyTest;

// Half floats hold it.
const std::vector<std::string> sky = {"sky.colour=[0.25,0.5,0.75]"};
const glm::vec3 skyColour(0.25f, 0.5f, 0.75f);

std::vector<std::string> with(std::vector<std::string> settings, const std::vector<std::string>& more) {
    settings.insert(settings.end(), more.begin(), more.end());
    return settings;
}

void expectNear(const glm::vec3& made, const glm::vec3& wanted, const std::string& what, float room = 2e-5f) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(made[k], wanted[k], room) << what << ", channel " << k;
}

const glm::vec4 red(0.9f, 0.1f, 0.2f, 0.5f), green(0.1f, 0.8f, 0.3f, 0.25f), blue(0.2f, 0.3f, 1.0f, 0.75f);

TEST_F(Composite, PanesLeaveWhatTheClosedFormSaysFromEveryGiverOfLayers) {
    // Not in the order of depth.
    const Scene scene = panesScene({{0, green}, {1, red}, {-1, blue}});
    const glm::vec3 wanted = over({red, green, blue}, skyColour);
    std::vector<std::vector<std::string>> givers = {{"transparent.layers=peeling.layers"},
                                                    {"transparent.layers=k_buffer.layers"}};
    for (const char* structure : {"sb", "dllb"})
        givers.push_back({std::string("store.structure=") + structure});
    givers.push_back({"store.structure=ll", "store.decoupled=false"});
    givers.push_back({"store.structure=dllb", "store.buckets=16", "store.allocation=counter"});
    givers.push_back({"depth_bounds.blended=kept"});
    for (const std::vector<std::string>& giver : givers) {
        const Image image = made(scene, {exactly}, with(sky, giver)).front();
        expectNear(middleOf(image), wanted, giver.front());
        EXPECT_NEAR(image.at(image.width / 2, image.height / 2, 3), 1 - 0.5f * 0.75f * 0.25f, 1e-6f);
    }
}

TEST_F(Composite, WhatIsOpaqueOrMaskedEndsTheList) {
    for (const AlphaMode mode : {AlphaMode::Opaque, AlphaMode::Mask}) {
        const glm::vec4 wall(0.3f, 0.3f, 0.1f, 0.9f);
        const Scene scene = panesScene({{0, wall, mode}, {1, red}, {-1, blue}});
        const glm::vec3 wanted = over({red}, glm::vec3(wall));
        for (const char* setting :
             {"depth_bounds.blended=alone", "depth_bounds.blended=kept", "transparent.layers=peeling.layers",
              "transparent.layers=k_buffer.layers"})
            expectNear(middleOf(made(scene, {exactly}, with(sky, {setting})).front()), wanted, setting,
                       3e-4f);
        expectNear(middleOf(made(scene, {weighted}, sky).front()), wanted, "weighted", 3e-4f);
    }
}

TEST_F(Composite, ALowAlphaIsDrawnAndAlphaZeroIsNot) {
    const glm::vec4 faint(1, 0, 0, 0.02f), nothing(1, 1, 1, 0);
    const Scene scene = panesScene({{1, nothing}, {0, faint}});
    const glm::vec3 wanted = over({faint}, skyColour);
    for (const char* setting : {"depth_bounds.blended=alone", "depth_bounds.blended=kept",
                                "transparent.layers=peeling.layers", "transparent.layers=k_buffer.layers"})
        expectNear(middleOf(made(scene, {exactly}, with(sky, {setting})).front()), wanted, setting);
    expectNear(middleOf(made(scene, {weighted}, sky).front()), wanted, "weighted");
    // As a masked material it falls below its cutoff.
    expectNear(middleOf(made(scene, {opaquely}, with(sky, {"gbuffer.blended=masked"})).front()), skyColour,
               "masked", 3e-4f);
}

TEST_F(Composite, BacksOfSingleSidedPanesAreNotThere) {
    Pane back{1, red}, front{0.5f, green};
    back.doubleSided = front.doubleSided = false;
    back.turned = true;
    const Scene scene = panesScene({back, front, {-1, blue}});
    const glm::vec3 wanted = over({green, blue}, skyColour);
    for (const char* setting : {"depth_bounds.blended=alone", "transparent.layers=peeling.layers",
                                "transparent.layers=k_buffer.layers"})
        expectNear(middleOf(made(scene, {exactly}, with(sky, {setting})).front()), wanted, setting);
    if (shipped().find("ReferenceTransparency") != nullptr)
        expectNear(middleOf(made(scene, {truly}, sky).front()), wanted, "reference", 3e-4f);
}

TEST_F(Composite, SurfacesAtOneDepthComeInTheOrderOfTheirTriangles) {
    const Scene scene = panesScene({{0, red}, {0, blue}, {0, green}});
    const glm::vec3 wanted = over({red, blue, green}, skyColour);
    for (const char* setting :
         {"store.structure=sb", "store.allocation=counter", "transparent.layers=k_buffer.layers"})
        expectNear(middleOf(made(scene, {exactly}, with(sky, {setting})).front()), wanted, setting);
    if (shipped().find("ReferenceTransparency") != nullptr)
        expectNear(middleOf(made(scene, {truly}, sky).front()), wanted, "reference", 3e-4f);
    // Peeling tells surfaces apart by depth alone.
    expectNear(middleOf(made(scene, {exactly}, with(sky, {"transparent.layers=peeling.layers"})).front()),
               over({red}, skyColour), "peeling");
}

TEST_F(Composite, OfMoreSurfacesThanTheyHoldTheNearestStay) {
    std::vector<Pane> panes;
    std::vector<glm::vec4> nearest;
    for (int i = 0; i < 12; ++i) {
        const float share = static_cast<float>(i) / 11;
        const glm::vec4 colour(share, 1 - share, 0.5f, 0.2f);
        panes.insert(panes.begin() + (i % 2 == 0 ? 0 : static_cast<int>(panes.size())),
                     {1 - 0.1f * static_cast<float>(i), colour});
        nearest.push_back(colour);
    }
    const Scene scene = panesScene(panes);
    expectNear(middleOf(made(scene, {exactly}, sky).front()), over(nearest, skyColour), "all");
    for (const size_t count : {size_t{1}, size_t{4}, size_t{8}}) {
        const glm::vec3 wanted =
            over({nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count)}, skyColour);
        expectNear(middleOf(made(scene, {exactly},
                                 with(sky, {"transparent.layers=peeling.layers",
                                            fmt::format("peeling.layers_per_pixel={}", count)}))
                                .front()),
                   wanted, "peeling");
        expectNear(middleOf(made(scene, {exactly},
                                 with(sky, {"transparent.layers=k_buffer.layers",
                                            fmt::format("k_buffer.slots={}", count)}))
                                .front()),
                   wanted, "k-buffer");
    }
    // What lets through no more than the cutoff ends it: 0.8^4 = 0.41 does, 0.8^3 does not.
    expectNear(middleOf(made(scene, {exactly}, with(sky, {"transparent.cutoff=0.42"})).front()),
               over({nearest.begin(), nearest.begin() + 4}, skyColour), "cutoff");
}

TEST_F(Composite, MoreSurfacesThanOneStepShadesTakeMore) {
    // Without lights a step shades 5,000.
    const glm::vec4 faint(0.6f, 0.2f, 0.4f, 0.001f);
    std::vector<Pane> panes;
    for (int i = 0; i < 5'200; ++i) panes.push_back({1 - 2e-4f * static_cast<float>(i), faint});
    const Image image = made(panesScene(panes), {exactly}, sky, {4, 3, 1}).front();
    const double through = std::pow(1 - 0.001, 5'200);
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(image.at(2, 1, k), double{faint[k]} * (1 - through) + double{skyColour[k]} * through,
                    1e-4);
}

TEST_F(Composite, WeightedIsExactForOneSurfaceAndForOneColour) {
    const glm::vec3 colour(0.3f, 0.7f, 0.5f);
    for (const char* weight : {"none", "equation_7", "equation_8", "equation_9", "equation_10"}) {
        const std::string setting = std::string("weighted.weight=") + weight;
        expectNear(middleOf(made(panesScene({{0, red}}), {weighted}, with(sky, {setting})).front()),
                   over({red}, skyColour), setting);
        const Scene same = panesScene({{0, {colour, 0.3f}}, {1, {colour, 0.6f}}, {-1, {colour, 0.2f}}});
        expectNear(middleOf(made(same, {weighted}, with(sky, {setting})).front()),
                   over({{colour, 0.6f}, {colour, 0.3f}, {colour, 0.2f}}, skyColour), setting);
    }
    // Equation 6 by hand, without weights: mean 0.5 and 0.25 of the two, and 3/8 let through.
    const Scene panes = panesScene({{0, green}, {1, red}});
    const glm::vec3 mean = (0.5f * glm::vec3(red) + 0.25f * glm::vec3(green)) / 0.75f;
    expectNear(middleOf(made(panes, {weighted}, with(sky, {"weighted.weight=none"})).front()),
               mean * 0.625f + skyColour * 0.375f, "equation 6");
    // Which of them comes first makes no difference.
    const Scene turned = panesScene({{1, green}, {0, red}});
    expectNear(middleOf(made(turned, {weighted}, with(sky, {"weighted.weight=none"})).front()),
               mean * 0.625f + skyColour * 0.375f, "turned");
}

TEST_F(Composite, WithoutBlendedMaterialsThePictureStaysAndNothingIsMade) {
    const Scene scene = loadScene("builtin:hall?detail=0.05");
    for (const PortRef& output : {exactly, weighted}) {
        Renderer left = renderer(transparencyGraph({output, opaquely}), scene);
        left.frame();
        const Image picture = left.read(opaquely);
        EXPECT_EQ(left.read(output).values, picture.values);
        bool told = false;
        for (const LeftOut& item : left.plan().leftOut)
            told |= item.why.find("no material is blended: the picture stays as it is") != std::string::npos;
        EXPECT_TRUE(told) << output.text();
        for (const PlanPass& pass : left.plan().passes)
            EXPECT_TRUE(pass.name != "store" && pass.name != "reorder" && pass.name != "weighted" &&
                        pass.name != "transparent")
                << pass.name << " is made";
        RenderOptions all;
        all.keepAll = true;
        Renderer kept = renderer(transparencyGraph({output, opaquely}), scene, all);
        kept.frame();
        EXPECT_EQ(kept.read(output).values, picture.values);
    }
}

TEST_F(Composite, LayersThatDoNotServeAreRefused) {
    const auto refused = [](const std::vector<std::string>& settings) {
        return messageOf<InputError>([&] {
            renderer(transparencyGraph({exactly}, settings), panesScene({{0, red}}));
        });
    };
    EXPECT_THAT(refused({"gbuffer.guard=8"}), testing::HasSubstr("without guard band"));
    Graph graph = transparencyGraph({exactly});
    const Graph second = parseGraph(R"({"kestrel": 1, "passes": {"gbuffer": {"type": "GBuffer"},
        "second": {"type": "SecondDepthLayer"}}, "edges": [["gbuffer.view_depth", "second.view_depth"]],
        "outputs": []})",
                                    "test.json");
    graph.passes.push_back(second.passes.back());
    graph.edges.push_back(second.edges.back());
    applySetting(graph, shipped(), "transparent.layers=second.layers");
    EXPECT_THAT(messageOf<InputError>([&] {
                    renderer(graph, panesScene({{0, red}}));
                }),
                testing::HasSubstr("needs the triangles of samples"));
}

TEST_F(Composite, WhatLayersDoNotHoldIsToldToBeLeftOut) {
    const std::pair<std::vector<std::string>, const char*> cases[] = {
        {{"depth_bounds.blended=tested"}, "blended surfaces below their cutoff"},
        {{"depth_bounds.main_view=false", "depth_bounds.cube=true", "depth_bounds.side=8"}, "layers"},
        {{"gbuffer.jitter=true"}, "jitter of blended surfaces"}};
    for (const auto& [settings, what] : cases) {
        Renderer made = renderer(transparencyGraph({exactly}, with(sky, settings)), panesScene({{0, red}}));
        made.frame();
        bool told = false;
        for (const LeftOut& item : made.plan().leftOut) told |= item.what.find(what) != std::string::npos;
        EXPECT_TRUE(told) << what;
    }
    // Red's alpha is its cutoff; a pane below it is not there.
    const Scene scene = panesScene({{0, red}, {1, green}});
    expectNear(middleOf(made(scene, {exactly}, with(sky, {"depth_bounds.blended=tested"})).front()),
               over({red}, skyColour), "tested");
}

// ---- against Embree

// Without shadows, which maps and rays have elsewhere by their texels.
const std::vector<std::string> compared = {"direct.shadows=false", "truth.shadows=false"};

double apartFromTruth(const Scene& scene, const Extent& size, const std::string& camera,
                      const std::vector<std::string>& settings = compared) {
    const std::vector<Image> images =
        Composite::made(scene, {exactly, truly, surfacesMet}, settings, size, camera);
    EXPECT_GE(*std::max_element(images[2].values.begin(), images[2].values.end()), 1.0f) << "nothing blended";
    return shareApart(images[0], images[1]);
}

// The triangles of every mesh, and the meshes, in another order.
Scene shuffled(Scene scene, unsigned seed) {
    std::mt19937 random(seed);
    for (Mesh& mesh : scene.meshes)
        for (Primitive& primitive : mesh.primitives) {
            std::vector<glm::uvec3> triangles;
            for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3)
                triangles.emplace_back(primitive.indices[i], primitive.indices[i + 1],
                                       primitive.indices[i + 2]);
            std::shuffle(triangles.begin(), triangles.end(), random);
            for (size_t i = 0; i < triangles.size(); ++i)
                for (int k = 0; k < 3; ++k)
                    primitive.indices[3 * i + static_cast<size_t>(k)] = triangles[i][k];
        }
    std::shuffle(scene.roots.begin(), scene.roots.end(), random);
    return scene;
}

TEST_F(Composite, TheLatticeIsAsEmbreeHasItWhateverTheOrderOfItsTriangles) {
    if (shipped().find("ReferenceTransparency") == nullptr) GTEST_SKIP() << "built without Embree";
    const Scene scene = loadScene("builtin:lattice?blended=0.2");
    for (const char* camera : {"front", "corner"}) {
        const double apart = apartFromTruth(scene, {128, 72, 1}, camera);
        const double other = apartFromTruth(shuffled(scene, 7), {128, 72, 1}, camera);
        RecordProperty(std::string("apart_") + camera, fmt::format("{:.5f} {:.5f}", apart, other));
        EXPECT_LE(apart, 0.001) << camera;
        EXPECT_LE(other, 0.001) << camera << ", shuffled";
    }
}

TEST_F(Composite, BarsAboutTheEyeAndParallelRaysAreAsEmbreeHasThem) {
    if (shipped().find("ReferenceTransparency") == nullptr) GTEST_SKIP() << "built without Embree";
    // Slivers too: long, thin, and seen from near and far.
    const Scene scene = loadScene("builtin:lattice?blended=0.2&detail=0.3");
    const auto looking = [](const glm::vec3& eye, const glm::vec3& target, bool parallel) {
        CameraState camera;
        camera.view = glm::lookAt(eye, target, glm::vec3(0, 1, 0));
        camera.position = eye;
        camera.orthographic = parallel;
        camera.nearPlane = 0.003f;
        camera.farPlane = 0;
        return camera;
    };
    for (const CameraState& camera :
         {looking({0.13f, 0.07f, -2.02f}, {0.7f, 0.2f, -3}, false),
          looking({0, 0.1f, -1}, {1, 0.3f, -1.1f}, false), looking({1.5f, 1, 3}, {0, 0, -2}, true)}) {
        RenderOptions options;
        options.checkFinite = true;
        Renderer made = renderer(transparencyGraph({exactly, truly}, compared), scene, options, {128, 72, 1});
        made.setFreeCamera(camera);
        made.frame();
        EXPECT_LE(shareApart(made.read(exactly), made.read(truly)), 0.001) << camera.position.x;
    }
}

TEST_F(Composite, HighlightsOfGlassAreTheReferences) {
    if (shipped().find("ReferenceTransparency") == nullptr) GTEST_SKIP() << "built without Embree";
    const Scene scene = loadScene("builtin:lattice?blended=0.2&detail=0.1");
    const std::vector<std::string> shining =
        with(compared, {"direct.highlights=true", "truth.highlights=true"});
    const std::vector<Image> images = made(scene, {exactly, truly}, shining, {96, 54, 1}, "corner");
    EXPECT_LE(shareApart(images[0], images[1]), 0.001);
    const Image dull = made(scene, {exactly}, compared, {96, 54, 1}, "corner").front();
    EXPECT_GT(shareApart(images[0], dull), 0.05) << "there are none";
}

TEST_F(Composite, TheHouseOfGlassIsAsEmbreeHasItWhateverTheOrderOfItsTriangles) {
    if (shipped().find("ReferenceTransparency") == nullptr) GTEST_SKIP() << "built without Embree";
    const auto file = assetsFolder() / "fzk-haus-blend" / "fzk-haus.glb";
    if (assetsFolder().empty() || !std::filesystem::exists(file)) GTEST_SKIP() << "there is no " << file;
    const Scene scene = loadScene(file.string());
    for (const Scene& each : {scene, shuffled(scene, 11)}) {
        const double apart = apartFromTruth(each, {320, 180, 1}, "");
        RecordProperty("apart", fmt::format("{:.5f}", apart));
        EXPECT_LE(apart, 0.001);
    }
}

} // namespace
} // namespace kestrel::test
