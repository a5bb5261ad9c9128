#include "scene/fact_list.h"

namespace kestrel {
namespace {

void noTextures(SceneFacts& facts) {
    facts.hasTextures = facts.hasNormalMaps = facts.hasTiledTextures = false;
    facts.images = facts.colourTextureArrays = facts.dataTextureArrays = 0;
}

void noMasked(SceneFacts& facts) {
    facts.hasMasked = facts.hasBlend = false;
    facts.maskedTriangles = 0;
}

void geometryRests(SceneFacts& facts) { facts.geometryMoves = facts.geometryDeforms = false; }

void noAreaLight(SceneFacts& facts) { facts.rectangleLights = facts.sphereLights = 0; }

void noPunctualLight(SceneFacts& facts) {
    facts.pointLights = facts.spotLights = facts.wideSpotLights = facts.directionalLights = 0;
}

// Facts are gathered of materials that some triangle uses.
void noTriangle(SceneFacts& facts) {
    noTextures(facts);
    noMasked(facts);
    geometryRests(facts);
    facts.hasDoubleSided = facts.hasSingleSided = facts.hasVertexColours = false;
    facts.hasEmission = facts.hasTransmission = facts.hasUnlit = false;
    facts.triangles = facts.vertices = 0;
    facts.instances = 0;
    facts.bounds = {};
    facts.sphere = {};
}

} // namespace

const std::vector<SceneFact>& sceneFactList() {
    static const std::vector<SceneFact> facts = {
        {"no triangle", noTriangle},
        {"triangles in one point only",
         [](SceneFacts& f) {
             f.bounds = {};
             f.bounds.add(f.sphere.centre);
             f.sphere.radius = 0;
         }},
        {"no masked or blended material", noMasked},
        {"no blended material", [](SceneFacts& f) { f.hasBlend = false; }},
        {"no single-sided material", [](SceneFacts& f) { f.hasSingleSided = false; }},
        {"no double-sided material", [](SceneFacts& f) { f.hasDoubleSided = false; }},
        {"no texture", noTextures},
        {"no normal map", [](SceneFacts& f) { f.hasNormalMaps = false; }},
        {"no texture that shares a layer", [](SceneFacts& f) { f.hasTiledTextures = false; }},
        {"no vertex colour", [](SceneFacts& f) { f.hasVertexColours = false; }},
        {"no emission", [](SceneFacts& f) { f.hasEmission = false; }},
        {"no transmission", [](SceneFacts& f) { f.hasTransmission = false; }},
        {"no unlit material", [](SceneFacts& f) { f.hasUnlit = false; }},
        {"no light",
         [](SceneFacts& f) {
             noPunctualLight(f);
             noAreaLight(f);
             f.lightsMove = false;
         }},
        {"area lights only", noPunctualLight},
        {"no area light", noAreaLight},
        {"no point light", [](SceneFacts& f) { f.pointLights = 0; }},
        {"no spot light", [](SceneFacts& f) { f.spotLights = f.wideSpotLights = 0; }},
        {"no spot light beyond 80 degrees", [](SceneFacts& f) { f.wideSpotLights = 0; }},
        {"no directional light", [](SceneFacts& f) { f.directionalLights = 0; }},
        {"no rectangle light", [](SceneFacts& f) { f.rectangleLights = 0; }},
        {"no sphere light", [](SceneFacts& f) { f.sphereLights = 0; }},
        {"geometry at rest", geometryRests, true},
        {"nothing deforms", [](SceneFacts& f) { f.geometryDeforms = false; }, true},
        {"cameras at rest", [](SceneFacts& f) { f.cameraMoves = false; }, true},
        {"lights at rest", [](SceneFacts& f) { f.lightsMove = false; }, true},
        {"everything at rest",
         [](SceneFacts& f) {
             geometryRests(f);
             f.cameraMoves = f.lightsMove = false;
             f.duration = 0;
         },
         true},
    };
    return facts;
}

SceneFacts withoutPromises(SceneFacts facts) {
    facts.hasMasked = facts.hasBlend = facts.hasDoubleSided = facts.hasSingleSided = true;
    facts.hasTextures = facts.hasNormalMaps = facts.hasVertexColours = true;
    facts.hasEmission = facts.hasTransmission = facts.hasUnlit = true;
    facts.geometryMoves = facts.geometryDeforms = facts.cameraMoves = facts.lightsMove = true;
    return facts;
}

SceneFacts richFacts() {
    SceneFacts rich;
    // Every field by its place: one that is added does not compile before it is decided here, and in the
    // list.
    auto& [triangles, vertices, materials, images, instances, maskedTriangles, hasMasked, hasBlend,
           hasDoubleSided, hasSingleSided, hasTextures, colourTextureArrays, dataTextureArrays,
           hasTiledTextures, hasNormalMaps, hasVertexColours, hasEmission, hasTransmission, hasUnlit,
           geometryMoves, geometryDeforms, cameraMoves, lightsMove, pointLights, spotLights,
           directionalLights, rectangleLights, sphereLights, wideSpotLights, cameras, duration, bounds,
           sphere] = rich;
    triangles = 1000;
    vertices = 3 * triangles;
    materials = 10;
    images = 5;
    instances = 4;
    maskedTriangles = 100;
    colourTextureArrays = 2;
    dataTextureArrays = 1;
    hasTiledTextures = true;
    pointLights = spotLights = directionalLights = rectangleLights = sphereLights = 2;
    wideSpotLights = 1;
    cameras = {"camera"};
    duration = 1;
    bounds.add(glm::vec3(-1));
    bounds.add(glm::vec3(1));
    sphere = {glm::vec3(0), 1.8f};
    return withoutPromises(rich);
}

} // namespace kestrel
