// Path tracing by the reference where it is known by hand: furnaces for each BSDF, the integrating sphere,
// one bounce.
#include "core/error.h"
#include "reference/path_trace.h"
#include "reference/sampling.h"
#include "reference_world.h"
#include "shared/bsdf.h"
#include <gtest/gtest.h>
#include <optional>
#include <random>
#include <tuple>

namespace kestrel {
namespace {

// What the first surface is; the world's material says what paths meet.
struct FirstSurface {
    glm::vec3 position{0, -2, 0}, normal{0, 1, 0};
    float cosView = 1;
};

struct PathWorld : LitWorld {
    explicit PathWorld(const Material& material) { scene = materialsScene({material}); }

    [[nodiscard]] PathResult trace(const FirstSurface& first, const PathSettings& settings) const {
        const Material& material = scene.materials.front();
        PathInputs inputs;
        inputs.position = row({first.position});
        inputs.normal = row({first.normal});
        inputs.albedo = row({glm::vec3(material.baseColour)});
        inputs.material = row({{material.roughness, material.metallic, material.unlit ? 1 : 0}});
        inputs.emission = row({material.emission});
        inputs.refraction = row({{material.transmission, shared::relativeIndex(material.ior, true), 0}});
        CameraState camera;
        const float sine = std::sqrt(1 - first.cosView * first.cosView);
        camera.position = first.position + basisOf(first.normal) * glm::vec3(sine, 0, first.cosView);
        if (!tracer) tracer.emplace(geometry, scene);
        return tracePaths({*tracer, geometry, scene, lights}, inputs, camera, settings);
    }
    mutable std::optional<ReferenceTracer> tracer; // of the geometry at the first call
    static glm::mat3 basisOf(const glm::vec3& n) { return basisAround(n); }
};

Material metalOf(const glm::vec3& colour, float roughness) {
    Material material = matteOf(colour);
    material.metallic = 1;
    material.roughness = roughness;
    return material;
}

// Nothing but a diffuse base: an interface of index 1 is none.
Material lambertOf(const glm::vec3& colour, const glm::vec3& emission = glm::vec3(0)) {
    Material material = matteOf(colour, emission);
    material.ior = 1;
    return material;
}

PathSettings pathSettings(int bounces, int samples) {
    PathSettings settings;
    settings.bounces = bounces;
    settings.samples = samples;
    return settings;
}

TEST(ReferencePath, TheFurnaceOfADiffuseRoomIsTheGeometricSeries) {
    GATHER_NEEDS_EMBREE();
    for (const float scale : {1e-4f, 1.0f, 1e4f}) {
        PathWorld world(lambertOf(glm::vec3(0.8f), glm::vec3(0.5f, 1, 2)));
        addRoundRoom(world.geometry, 2 * scale, 24);
        for (int bounces = 0; bounces <= 8; ++bounces) {
            const PathResult result = world.trace({scale * glm::vec3(0, -2, 0)}, pathSettings(bounces, 512));
            const float series = (1 - std::pow(0.8f, static_cast<float>(bounces + 1))) / 0.2f;
            for (int k = 0; k < 3; ++k) {
                const float emission = 0.5f * static_cast<float>(1 << k);
                EXPECT_NEAR(result.radiance.at(0, 0, k), emission * series, 0.005f * emission * series)
                    << bounces << " bounces, scale " << scale;
                EXPECT_NEAR(result.indirect.at(0, 0, k), emission * (series - 1), 0.005f * emission * series);
            }
        }
    }
}

// A round room keeps the cosine that a ray leaves with until it arrives, so that the light of k bounces is
// the k-th power of one integral operator over cosines. Here it is a matrix, summed over directions without
// any sampling of the BSDF.
class RoundFurnace {
public:
    RoundFurnace(double colour, double alpha, bool metal)
        : kernel_(cells * cells) {
        for (int v = 0; v < cells; ++v) {
            const double cosView = cosineOf(v), sinView = std::sqrt(1 - cosView * cosView);
            const double through = metal ? 0 : 1 - reflectedByFacets(cosView, alpha);
            for (int l = 0; l < cells; ++l) {
                const double c = cosineOf(l), s = std::sqrt(1 - c * c);
                double sum = 0;
                for (int j = 0; j < around; ++j) {
                    const double phi = std::numbers::pi * (j + 0.5) / around; // mirrored: twice
                    const double hx = s * std::cos(phi) + sinView, hy = s * std::sin(phi), hz = c + cosView;
                    const double size = std::sqrt(hx * hx + hy * hy + hz * hz), half = 0.5 * size;
                    const double fresnel =
                        metal ? colour + (1 - colour) * std::pow(1 - half, 5) : interface(half);
                    sum += fresnel * density(hz / size, alpha) /
                           (4 * cosView * c * (1 + lambda(c, alpha) + lambda(cosView, alpha)));
                }
                const double specular = sum * 2 * std::numbers::pi / around;
                const double diffuse = metal ? 0 : 2 * colour * through;
                kernel_[static_cast<size_t>(v * cells + l)] = (specular + diffuse) * c / cells;
            }
        }
    }

    // Of emission 1 after so many bounces, seen at this cosine.
    [[nodiscard]] double radiance(double cosView, int bounces) const {
        std::vector<double> order(cells, 1), sum(cells, 1);
        for (int k = 0; k < bounces; ++k) {
            std::vector<double> next(cells, 0);
            for (int v = 0; v < cells; ++v)
                for (int l = 0; l < cells; ++l)
                    next[static_cast<size_t>(v)] +=
                        kernel_[static_cast<size_t>(v * cells + l)] * order[static_cast<size_t>(l)];
            order.swap(next);
            for (size_t v = 0; v < cells; ++v) sum[v] += order[v];
        }
        const double place = cosView * cells - 0.5;
        const int low = std::clamp(static_cast<int>(std::floor(place)), 0, cells - 2);
        const double part = place - low;
        return (1 - part) * sum[static_cast<size_t>(low)] + part * sum[static_cast<size_t>(low) + 1];
    }

private:
    static constexpr int cells = 90, around = 48;
    static double cosineOf(int cell) { return (cell + 0.5) / cells; }
    static double lambda(double c, double alpha) {
        return 0.5 * (std::sqrt(1 + alpha * alpha * (1 - c * c) / (c * c)) - 1);
    }
    static double density(double c, double alpha) {
        const double q = c * c * (alpha * alpha - 1) + 1;
        return alpha * alpha / (std::numbers::pi * q * q);
    }
    // Fresnel's formulas by angles, of index 1.5.
    static double interface(double cosine) {
        const double t1 = std::acos(std::min(1.0, cosine)), t2 = std::asin(std::sin(t1) / 1.5);
        if (t1 < 1e-6) return 0.04;
        const double across = std::sin(t1 - t2) / std::sin(t1 + t2),
                     along = std::tan(t1 - t2) / std::tan(t1 + t2);
        return 0.5 * (across * across + along * along);
    }
    // The mean of the interface's reflectance over the microfacets that the view sees.
    static double reflectedByFacets(double cosView, double alpha) {
        const double sinView = std::sqrt(1 - cosView * cosView);
        double sum = 0, seen = 0;
        for (int i = 0; i < cells; ++i)
            for (int j = 0; j < around; ++j) {
                const double c = cosineOf(i), s = std::sqrt(1 - c * c);
                const double phi = std::numbers::pi * (j + 0.5) / around;
                const double cosine = sinView * s * std::cos(phi) + cosView * c;
                if (cosine <= 0) continue;
                seen += cosine * density(c, alpha);
                sum += cosine * density(c, alpha) * interface(cosine);
            }
        return sum / seen;
    }
    std::vector<double> kernel_;
};

// What single scattering loses (the sum is below the geometric series) both sides lose: the truth is the
// BSDF's own.
TEST(ReferencePath, TheFurnacesOfMetalAndOfAnInterfaceOverADiffuseBaseAreTheirOperatorsPowers) {
    GATHER_NEEDS_EMBREE();
    for (const bool metal : {true, false})
        for (const float roughness : {0.5f, 0.9f}) {
            Material material = metal ? metalOf(glm::vec3(0.8f), roughness) : matteOf(glm::vec3(0.8f));
            material.roughness = roughness;
            material.emission = glm::vec3(1);
            PathWorld world(material);
            addRoundRoom(world.geometry, 2, 96);
            const RoundFurnace truth(double{0.8f}, double{roughness * roughness}, metal);
            for (const float cosView : {0.3f, 0.9f})
                for (const int bounces : {1, 4}) {
                    const float light =
                        world.trace({.cosView = cosView}, pathSettings(bounces, 6000)).radiance.at(0, 0, 0);
                    const double expected = truth.radiance(double{cosView}, bounces);
                    EXPECT_NEAR(light, expected, 0.005 * expected)
                        << (metal ? "metal " : "dielectric ") << roughness << ", " << cosView << ", "
                        << bounces;
                }
        }
}

// How much that is of white metal, seen at 45 degrees: a fifth at roughness 0.6, three fifths of
// the roughest.
TEST(ReferencePath, SingleScatteringLosesWhatTheOperatorSays) {
    for (const auto& [roughness, least, most] :
         {std::tuple{0.4, 0.92, 0.98}, {0.6, 0.77, 0.82}, {1.0, 0.36, 0.40}}) {
        const double albedo = RoundFurnace(1, roughness * roughness, true).radiance(std::sqrt(0.5), 1) - 1;
        EXPECT_GT(albedo, least) << roughness;
        EXPECT_LT(albedo, most) << roughness;
    }
}

TEST(ReferencePath, AMirrorsFurnaceIsTheSeriesOfItsFresnelTerm) {
    GATHER_NEEDS_EMBREE();
    Material material = metalOf(glm::vec3(0.8f), 0);
    material.emission = glm::vec3(1);
    PathWorld world(material);
    addRoundRoom(world.geometry, 2, 96);
    for (const float cosView : {0.4f, 0.8f}) {
        const double fresnel = 0.8 + 0.2 * std::pow(1 - double{cosView}, 5);
        for (const int bounces : {1, 4, 8}) {
            const double expected = (1 - std::pow(fresnel, bounces + 1)) / (1 - fresnel);
            EXPECT_NEAR(world.trace({.cosView = cosView}, pathSettings(bounces, 256)).radiance.at(0, 0, 0),
                        expected, 0.005 * expected)
                << cosView << " " << bounces;
        }
    }
}

// A glass ball that glows a little in surroundings of radiance 1. Inside of it a ray meets the surface at one
// angle again and again, and by reciprocity that reflects as much as outside.
TEST(ReferencePath, AGlassBallsFurnaceIsTheSeriesOfItsReflections) {
    GATHER_NEEDS_EMBREE();
    for (const float ior : {1.33f, 2.4f}) {
        Material material = matteOf(glm::vec3(0.8f), glm::vec3(0.25f));
        material.transmission = 1;
        material.roughness = 0;
        material.ior = ior;
        PathWorld world(material);
        addRoundRoom(world.geometry, 1, 128);
        for (size_t i = 0; i < world.geometry.indices.size(); i += 3) // turned inside out
            std::swap(world.geometry.indices[i], world.geometry.indices[i + 1]);
        for (VertexAttributes& vertex : world.geometry.attributes) vertex.normal = -vertex.normal;
        for (const float cosView : {0.35f, 0.6f, 0.9f}) {
            const double f = double{shared::dielectricFresnel(cosView, ior)};
            for (const int bounces : {1, 2, 3, 8}) {
                PathSettings settings = pathSettings(bounces, 8192);
                settings.environment = glm::vec3(1);
                const FirstSurface first{glm::vec3(0, 0, 1), {0, 0, 1}, cosView};
                double expected =
                    0.25 + f; // its own light; reflected: the surroundings are met by the first ray
                double inside = (1 - f) * 0.8;
                for (int k = 1; k <= bounces; ++k) {
                    // Ray k inside meets the surface, and by a ray more what leaves there meets the
                    // surroundings.
                    expected += 0.25 * inside;
                    if (k < bounces) expected += inside * (1 - f) * 0.8;
                    inside *= f;
                }
                EXPECT_NEAR(world.trace(first, settings).radiance.at(0, 0, 0), expected, 0.005 * expected)
                    << ior << ", " << cosView << ", " << bounces;
            }
        }
    }
}

TEST(ReferencePath, GlassThatIsNotThereChangesNothing) {
    GATHER_NEEDS_EMBREE();
    Material material = matteOf(glm::vec3(1));
    material.transmission = 1;
    material.ior = 1;
    PathWorld world(material);
    addSquare(world.geometry, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0});
    PathSettings settings = pathSettings(1, 16);
    settings.environment = {1, 2, 4};
    for (int k = 0; k < 3; ++k)
        EXPECT_FLOAT_EQ(world.trace({{0, 0, 0}, {0, 1, 0}, 0.5f}, settings).radiance.at(0, 0, k),
                        settings.environment[k]);
}

// No choice of numbers gives a path more than arrives, nor does their mean.
TEST(ReferencePath, NoBsdfSendsOutMoreThanArrives) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0, 1);
    for (int i = 0; i < 300; ++i) {
        const auto extreme = [&] { return unit(random) < 0.3f ? std::round(unit(random)) : unit(random); };
        const shared::BsdfSurface surface{
            glm::vec3(extreme(), 1, extreme()), extreme(), extreme(), extreme(),
            shared::relativeIndex(1 + 1.5f * unit(random), unit(random) < 0.5f)};
        const float cosine = std::max(1e-4f, extreme());
        const glm::vec3 view(std::sqrt(1 - cosine * cosine), 0, cosine);
        glm::dvec3 mean(0);
        constexpr int samples = 256;
        for (int k = 0; k < samples; ++k) {
            const auto s = shared::sampleBsdf(surface, view, unit(random), {unit(random), unit(random)},
                                              cosineDirection({unit(random), unit(random)}));
            if (s.lobe == shared::bsdfNone) continue;
            EXPECT_NEAR(glm::length(s.direction), 1, 1e-4f);
            EXPECT_EQ(s.direction.z < 0, s.lobe == shared::bsdfTransmission);
            for (int c = 0; c < 3; ++c) {
                ASSERT_TRUE(s.weight[c] >= 0 && s.weight[c] <= 1.00001f) << s.weight[c];
                ASSERT_TRUE(s.diffuse[c] >= 0 && s.diffuse[c] <= 1);
            }
            mean += glm::dvec3(s.weight) / double{samples};
        }
        for (int c = 0; c < 3; ++c) EXPECT_LE(mean[c], 1.00001);
    }
}

// A point light in the middle of a round room: every point of the wall gets I / R^2, and every bounce albedo
// times as much.
TEST(ReferencePath, TheIntegratingSphereBounceByBounce) {
    GATHER_NEEDS_EMBREE();
    PathWorld world(lambertOf({0.8f, 0.4f, 0}));
    addRoundRoom(world.geometry, 2, 96);
    world.lights = {lightOf(LightKind::Point, {0, 0, 0}, 3)};
    for (const int bounces : {0, 1, 3}) {
        const PathResult result = world.trace({.cosView = 0.6f}, pathSettings(bounces, 2048));
        for (int k = 0; k < 2; ++k) {
            const float albedo = k == 0 ? 0.8f : 0.4f, direct = albedo * 3 / 4 / pi;
            const float all = direct * (1 - std::pow(albedo, static_cast<float>(bounces + 1))) / (1 - albedo);
            EXPECT_NEAR(result.radiance.at(0, 0, k), all, 0.003f * all) << bounces;
            EXPECT_NEAR(result.indirect.at(0, 0, k), all - direct, 0.003f * all) << bounces;
        }
        EXPECT_EQ(result.radiance.at(0, 0, 2), 0.0f);
    }
}

// An open scene with a wall, a lamp and an area light: one bounce is what the gathering of one bounce says of
// a diffuse surface.
TEST(ReferencePath, OneBounceOffDiffuseSurfacesIsThatOfTheGathering) {
    GATHER_NEEDS_EMBREE();
    PathWorld world(lambertOf({0.7f, 0.5f, 0.3f}));
    addSquare(world.geometry, {-2, 0, -2}, {0, 0, 4}, {4, 0, 0});
    addSquare(world.geometry, {-2, 0, -1}, {4, 0, 0}, {0, 3, 0});
    world.lights = {lightOf(LightKind::Point, {0.3f, 2, 0.5f}, 4),
                    lightOf(LightKind::Rectangle, {0, 2.5f, 0}, 2)};
    world.lights[1].halfSize = {0.4f, 0.4f};
    GatherSettings gathering;
    gathering.samples = 1 << 15;
    gathering.environment = {0.1f, 0.2f, 0.3f};
    const GatherResult bounce = world.bounce(pointsFacing({{0.2f, 0, -0.5f}}, {0, 1, 0}), gathering);
    PathSettings settings = pathSettings(1, 1 << 15);
    settings.environment = gathering.environment;
    const PathResult path = world.trace({{0.2f, 0, -0.5f}, {0, 1, 0}}, settings);
    for (int k = 0; k < 3; ++k) {
        const float expected = world.scene.materials[0].baseColour[k] * bounce.light.at(0, 0, k);
        EXPECT_NEAR(path.indirect.at(0, 0, k), expected, 4 * (bounce.noise + path.noise) + 1e-3f * expected);
        EXPECT_GT(expected, 0.02f);
    }
}

// A glowing panel, and a light that stands for it: the same picture whether the light is sampled or the panel
// found. Which of them decides in how many bounces light is found, so there are as many as may be.
TEST(ReferencePath, TheLightOfAPanelCountsOnce) {
    GATHER_NEEDS_EMBREE();
    for (const float metallic : {0.0f, 0.5f}) {
        Material walls = matteOf(glm::vec3(0.6f));
        walls.metallic = metallic;
        walls.roughness = 0.4f;
        PathWorld world(walls);
        world.scene.materials.push_back(matteOf(glm::vec3(0.5f), glm::vec3(3)));
        addSquare(world.geometry, {-2, 0, -2}, {0, 0, 4}, {4, 0, 0});
        addSquare(world.geometry, {-2, 0, -1}, {4, 0, 0}, {0, 3, 0});
        addSquare(world.geometry, {-0.5f, 1.5f, -0.5f}, {1, 0, 0}, {0, 0, 1}, 1);
        world.lights = {lightOf(LightKind::Rectangle, {0, 1.5f, 0}, 3)};
        world.lights[0].halfSize = {0.5f, 0.5f};
        PathSettings settings = pathSettings(8, 1 << 14);
        const FirstSurface first{{0.2f, 0, -0.5f}, {0, 1, 0}, 0.7f};
        const PathResult sampled = world.trace(first, settings);
        settings.areaLights = false;
        const PathResult found = world.trace(first, settings);
        EXPECT_NEAR(sampled.radiance.at(0, 0, 0), found.radiance.at(0, 0, 0),
                    4 * (sampled.noise + found.noise));
        EXPECT_LT(sampled.noise + found.noise, 0.03 * sampled.radiance.at(0, 0, 0));
    }
}

TEST(ReferencePath, AnUnlitSurfaceShowsItsColour) {
    GATHER_NEEDS_EMBREE();
    Material material = matteOf({0.2f, 0.4f, 0.6f});
    material.unlit = true;
    PathWorld world(material);
    addRoundRoom(world.geometry, 2, 16);
    world.lights = {lightOf(LightKind::Point, {0, 0, 0}, 3)};
    const PathResult result = world.trace({}, pathSettings(3, 64));
    EXPECT_EQ(result.radiance.at(0, 0, 2), 0.6f);
    EXPECT_EQ(result.indirect.at(0, 0, 2), 0.0f);
}

struct PathNoise : testing::Test {
    PathNoise()
        : world(lambertOf({0.7f, 0.5f, 0.3f})) {
        addSquare(world.geometry, {-2, 0, -2}, {0, 0, 4}, {4, 0, 0});
        addSquare(world.geometry, {-2, 0, -1}, {4, 0, 0}, {0, 3, 0});
        world.lights = {lightOf(LightKind::Point, {0.3f, 2, 0.5f}, 4)};
        std::vector<glm::vec3> points;
        for (int i = 0; i < 200; ++i)
            points.emplace_back(-1 + 0.1f * static_cast<float>(i % 20), 0,
                                -0.9f + 0.1f * static_cast<float>(i / 20));
        inputs.position = row(points);
        inputs.normal = row(std::vector<glm::vec3>(points.size(), glm::vec3(0, 1, 0)));
        inputs.albedo = Image(200, 1, 3, 0.7f);
        inputs.material = Image(200, 1, 3, 0);
        camera.position = {0, 3, 3};
    }
    [[nodiscard]] PathResult trace(const PathSettings& settings) const {
        const ReferenceTracer tracer(world.geometry, world.scene);
        return tracePaths({tracer, world.geometry, world.scene, world.lights}, inputs, camera, settings);
    }
    PathWorld world;
    PathInputs inputs;
    CameraState camera;
};

TEST_F(PathNoise, IsWhatTheNoiseSaysAndDoesNotDependOnThreads) {
    GATHER_NEEDS_EMBREE();
    PathSettings settings = pathSettings(3, 1024);
    const PathResult truth = trace(settings);
    settings.samples = 32;
    settings.seed = 1;
    const PathResult few = trace(settings);
    double sum = 0;
    for (size_t i = 0; i < truth.radiance.values.size(); ++i)
        sum += std::pow(double{few.radiance.values[i]} - double{truth.radiance.values[i]}, 2);
    const double rms = std::sqrt(sum / static_cast<double>(truth.radiance.values.size()));
    EXPECT_GT(few.noise, 0.6 * rms);
    EXPECT_LT(few.noise, 1.5 * rms);
    EXPECT_EQ(few.samples, 32u * 200u);
    settings.threads = 1;
    EXPECT_EQ(trace(settings).radiance, few.radiance);
    settings.seed = 2;
    EXPECT_NE(trace(settings).radiance, few.radiance);
}

TEST_F(PathNoise, EveryImageThatDoesNotFitIsNamed) {
    GATHER_NEEDS_EMBREE();
    inputs.albedo = Image(1, 1, 2);
    inputs.refraction = Image(200, 1, 1);
    try {
        (void)trace({});
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.problems().size(), 3u);
    }
}

} // namespace
} // namespace kestrel
