// What the reference takes a hit for is what shaders take it for: every feature of a material, crossed.
#include "ray_effects_fixture.h"
#include "reference/primary_hits.h"
#include "reference/surface_sample.h"
#include "scene/bvh_trace.h"

namespace kestrel::test {
namespace {

// A square with a texture in every place, vertex colours and a leaning normal map.
Scene richSquare() {
    Scene scene = trianglesScene(square());
    const auto image = [&](int number) {
        TextureImage made{fmt::format("image {}", number), 4, 4, {}};
        for (int i = 0; i < 16; ++i)
            for (int k = 0; k < 4; ++k)
                made.rgba.push_back(static_cast<std::uint8_t>(k == 3 ? 255
                                                              : number == 2
                                                                  ? (k == 2 ? 230 : 90 + 23 * ((i + k) % 4))
                                                                  : (40 * number + 67 * i + 91 * k) % 256));
        scene.images.push_back(made);
        return static_cast<int>(scene.images.size()) - 1;
    };
    Material& material = scene.materials[0];
    material.baseColour = {0.9f, 0.7f, 0.8f, 1};
    material.metallic = 0.8f;
    material.roughness = 0.6f;
    material.emission = {1, 2, 0.5f};
    material.normalScale = 0.7f;
    material.baseColourTexture.image = image(0);
    material.metallicRoughnessTexture.image = image(1);
    material.normalTexture.image = image(2);
    material.emissionTexture.image = image(3);
    material.baseColourTexture.offset = {0.25f, 0.1f};
    material.baseColourTexture.rotation = 0.5f;
    material.metallicRoughnessTexture.wrapS = Wrap::MirroredRepeat;
    material.emissionTexture.wrapT = Wrap::ClampToEdge;
    material.emissionTexture.texCoord = 1;
    Primitive& primitive = scene.meshes[0].primitives[0];
    for (const glm::vec3& p : primitive.positions) {
        primitive.texCoords.emplace_back(0.5f * p.x + 0.5f, 0.5f - 0.5f * p.y);
        primitive.texCoords1.emplace_back(0.8f * p.y, 0.6f * p.x);
        primitive.colours.emplace_back(0.75f + 0.25f * p.x, 0.5f, 0.75f - 0.25f * p.y, 1);
    }
    finishScene(scene);
    return scene;
}

struct Surfaces : EffectsTest {};

TEST_F(Surfaces, OfTheReferenceAreThoseOfTheShaders) {
    const Scene scene = richSquare();
    const Extent size{64, 64, 1};
    for (const glm::vec3& eye :
         {glm::vec3(0, 0, 2.5f), glm::vec3(1.2f, -0.8f, 1.8f), glm::vec3(0.4f, 0.6f, -2)}) {
        const CameraState camera = lookingAt(eye, {0, 0, 0});
        const std::vector<PortRef> ports = {{"gbuffer", "albedo"},
                                            {"gbuffer", "material"},
                                            {"gbuffer", "emission"},
                                            {"gbuffer", "normal"},
                                            {"gbuffer", "face_normal"}};
        const auto images = run(effectsGraph(ports), scene, ports, 1, camera, size);
        const Geometry geometry = flatten(scene, 0);
        const Bvh bvh = buildBvh(geometry);
        const SurfaceSampler sampler(geometry, scene);
        int covered = 0;
        double bent = 1;
        for (int y = 0; y < 64; ++y) {
            const std::vector<TraceRay> rays = cameraRays(camera, 64, 64, y);
            for (int x = 0; x < 64; ++x) {
                const auto hit = closestHit(bvh, rays[static_cast<size_t>(x)]);
                if (!hit || !(images[0].at(x, y, 3) > 0)) continue;
                ++covered;
                const SurfaceSample met = sampler.at(*hit, rays[static_cast<size_t>(x)].direction);
                bent = std::min(bent, double{glm::dot(met.normal, met.faceNormal)});
                ASSERT_NEAR(images[1].at(x, y, 0), met.roughness, 0.01f);
                ASSERT_NEAR(images[1].at(x, y, 1), met.metallic, 0.01f);
                // A normal that looks away from the eye is the face's, in a G-buffer alone.
                const bool seen = glm::dot(met.normal, rays[static_cast<size_t>(x)].direction) < -0.01f;
                for (int k = 0; k < 3; ++k) {
                    ASSERT_NEAR(images[0].at(x, y, k), met.albedo[k], 0.012f) << x << ", " << y;
                    ASSERT_NEAR(images[2].at(x, y, k), met.emission[k], 0.03f) << x << ", " << y;
                    ASSERT_NEAR(images[4].at(x, y, k), met.faceNormal[k], 1e-5f);
                    if (seen) {
                        ASSERT_NEAR(images[3].at(x, y, k), met.normal[k], 0.01f) << x << ", " << y;
                    }
                }
            }
        }
        EXPECT_GT(covered, 500);
        EXPECT_LT(bent, 0.96);
    }
}

// The same surface lights another: one bounce off it, by both.
TEST_F(Surfaces, SendOutTheSameLight) {
    if (!hasReferences()) GTEST_SKIP() << "Embree is not built in";
    Scene scene = richSquare();
    scene.materials[0].emission = glm::vec3(0);
    scene.materials[0].doubleSided = true;
    // A wall that it lights, and a lamp that leaves the wall dark.
    Scene wall = trianglesScene(parallelogram({1, -1, 0}, {0, 2, 0}, {0, 0, 2}));
    wall.meshes[0].primitives[0].material = 1;
    scene.materials.push_back(wall.materials[0]);
    scene.materials[1].metallic = 0;
    scene.meshes.push_back(wall.meshes[0]);
    Node node;
    node.mesh = 1;
    scene.roots.push_back(static_cast<int>(scene.nodes.size()));
    scene.nodes.push_back(node);
    Light lamp;
    lamp.kind = LightKind::Point;
    lamp.intensity = 10;
    addLightTo(scene, lamp, {0.2f, 0.3f, 2}, {1, 0, 0, 0});
    finishScene(scene);
    const CameraState camera = lookingAt({-2.5f, 0.2f, 1.5f}, {0.5f, 0, 0});
    const PortRef port{"indirect", "result"}, coverage{"gbuffer", "coverage"};
    const Image truth = run(embreeGraph({port}), scene, {port}, 1, camera)[0];
    const auto shaded = run(effectsGraph({bounce, coverage}, {"direct.resolution=2048"}), scene,
                            {bounce, coverage}, 64, camera);
    const double expected = meanWhere(truth, shaded[1]);
    EXPECT_GT(expected, 0.01);
    EXPECT_NEAR(meanWhere(shaded[0], shaded[1]) / expected, 1, 0.01);
}

} // namespace
} // namespace kestrel::test
