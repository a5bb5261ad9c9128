#include "scene/edit.h"
#include "scene/builtin/scene_builder.h"
#include "scene/builtin/split.h"
#include "scene/geometry.h"
#include "scene/timeline_bounds.h"
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace kestrel {
namespace {

// The scene's size and place, in the space below rootTransform.
struct Size {
    glm::dvec3 centre{0};
    double radius = 1;
};

Size sizeOf(const Scene& scene) {
    const TimelineBounds bounds = timelineBounds(scene, glm::dmat4(1));
    Size size;
    if (bounds.empty) return size;
    size.centre = bounds.centre();
    if (bounds.radius > 0) size.radius = bounds.radius;
    return size;
}

// ---- triangles

template<class T>
void reverseTriples(std::vector<T>& items) {
    std::ranges::reverse(items);
    for (size_t i = 0; i + 2 < items.size(); i += 3) std::swap(items[i], items[i + 2]);
}

void editPrimitive(Primitive& primitive, SceneEdit::Triangles how) {
    std::vector<std::uint32_t>& indices = primitive.indices;
    switch (how) {
    case SceneEdit::Triangles::AsTheyAre:
        break;
    case SceneEdit::Triangles::Reversed:
        reverseTriples(indices);
        break;
    case SceneEdit::Triangles::Doubled: {
        const std::vector<std::uint32_t> once = indices;
        indices.insert(indices.end(), once.begin(), once.end());
        break;
    }
    case SceneEdit::Triangles::Halved: {
        std::vector<std::uint32_t> half;
        for (size_t i = 0; i + 2 < indices.size(); i += 6)
            half.insert(half.end(), indices.begin() + static_cast<std::ptrdiff_t>(i),
                        indices.begin() + static_cast<std::ptrdiff_t>(i) + 3);
        indices = std::move(half);
        break;
    }
    case SceneEdit::Triangles::InsideOut:
        for (size_t i = 0; i + 2 < indices.size(); i += 3) std::swap(indices[i + 1], indices[i + 2]);
        for (glm::vec3& normal : primitive.normals) normal = -normal;
        break;
    }
}

void editTriangles(Scene& scene, const SceneEdit& edit) {
    const bool changes = edit.triangles != SceneEdit::Triangles::AsTheyAre;
    for (Mesh& mesh : scene.meshes)
        for (Primitive& primitive : mesh.primitives)
            // Flat normals belong to triangles with vertices of their own, in their order: where vertices are
            // shared or triangles change places they are made anew.
            if (primitive.flatNormals && (changes || edit.split > 1)) {
                primitive.normals.clear();
                primitive.tangents.clear();
                primitive.flatNormals = false;
            }
    builtin::splitTriangles(scene, edit.split);
    for (Mesh& mesh : scene.meshes) {
        for (Primitive& primitive : mesh.primitives) editPrimitive(primitive, edit.triangles);
        if (edit.triangles == SceneEdit::Triangles::Reversed) std::ranges::reverse(mesh.primitives);
    }
}

void addFarTriangle(Scene& scene, double offCentre, const Size& size) {
    const auto side = static_cast<float>(1e-3 * size.radius);
    Primitive primitive;
    primitive.indices = {0, 1, 2};
    primitive.positions = {glm::vec3(0), glm::vec3(side, 0, 0), glm::vec3(0, side, 0)};
    Node node;
    node.name = "far away";
    node.translation = size.centre + 2 * offCentre * size.radius * glm::dvec3(0.75, -0.55, 0.37);
    node.mesh = static_cast<int>(scene.meshes.size());
    scene.meshes.push_back({"far away", {std::move(primitive)}, {}});
    scene.roots.push_back(static_cast<int>(scene.nodes.size()));
    scene.nodes.push_back(std::move(node));
}

// ---- cameras

void lookAtCentre(Scene& scene, Camera& camera, const glm::dvec3& eye, const Size& size) {
    const glm::dvec3 place = size.centre + size.radius * eye;
    camera.path.clear();
    Node node;
    node.name = camera.name;
    node.translation = place;
    node.rotation = builtin::lookRotation(place, size.centre);
    node.camera = static_cast<int>(&camera - scene.cameras.data());
    if (camera.node >= 0) scene.nodes[static_cast<size_t>(camera.node)].camera = -1;
    camera.node = static_cast<int>(scene.nodes.size());
    scene.roots.push_back(camera.node);
    scene.nodes.push_back(std::move(node));
}

void editPlanes(Camera& camera, const SceneEdit& edit) {
    if (edit.fov) {
        camera.verticalFov = static_cast<float>(glm::radians(*edit.fov));
        for (CameraKey& key : camera.path) key.verticalFov = glm::radians(*edit.fov);
    }
    camera.nearPlane *= static_cast<float>(edit.nearFactor);
    if (edit.farOverNear) camera.farPlane = camera.nearPlane * static_cast<float>(*edit.farOverNear);
}

void editCameras(Scene& scene, const SceneEdit& edit, const Size& size) {
    if (!edit.eye && !edit.orthographic) {
        for (Camera& camera : scene.cameras) editPlanes(camera, edit);
        return;
    }
    // What cameraAt() tells stands in render space, with the scale of rootTransform; a scene whose root is
    // the identity gives the units of Camera.
    Scene plain = scene;
    plain.rootTransform = glm::dmat4(1);
    finishScene(plain);
    const glm::vec3 centre(size.centre - plain.origin);
    for (size_t i = 0; i < scene.cameras.size(); ++i) {
        Camera& camera = scene.cameras[i];
        if (edit.eye) {
            lookAtCentre(scene, camera, *edit.eye, size);
            lookAtCentre(plain, plain.cameras[i], *edit.eye, size);
        }
        const CameraState state = cameraAt(plain, static_cast<int>(i), scene.startTime);
        const double distance =
            std::max<double>(double(glm::distance(state.position, centre)), 1e-3 * size.radius);
        if (edit.orthographic) {
            camera.orthographic = true;
            camera.halfHeight = static_cast<float>(distance * std::tan(0.5 * double(state.verticalFov)));
            if (camera.farPlane <= 0) camera.farPlane = static_cast<float>(4 * (distance + size.radius));
        }
        editPlanes(camera, edit);
    }
}

// ---- materials

void editMaterials(Scene& scene, const SceneEdit& edit) {
    const bool any = edit.roughness || edit.metallic || edit.alphaCutoff || edit.albedo || edit.emission;
    if (!any) return;
    // What has no material gets one that can be changed.
    const int added = static_cast<int>(scene.materials.size());
    scene.materials.emplace_back();
    for (Mesh& mesh : scene.meshes)
        for (Primitive& primitive : mesh.primitives)
            if (primitive.material < 0) primitive.material = added;
    for (Material& material : scene.materials) {
        if (edit.roughness) material.roughness = *edit.roughness;
        if (edit.metallic) material.metallic = *edit.metallic;
        if (edit.roughness || edit.metallic) material.metallicRoughnessTexture = {};
        if (edit.albedo) {
            material.baseColour = glm::vec4(*edit.albedo, material.baseColour.a);
            material.baseColourTexture = {};
        }
        if (edit.emission) {
            material.emission = *edit.emission;
            material.emissionTexture = {};
        }
        if (edit.alphaCutoff) {
            material.alphaMode = AlphaMode::Mask;
            material.alphaCutoff = *edit.alphaCutoff;
        }
    }
}

// ---- lights

// The middle of the first triangle that has an extent, and its normal; the centre of a scene without one.
std::pair<glm::dvec3, glm::dvec3> firstSurface(const Scene& scene, const Size& size) {
    Scene plain = scene;
    plain.rootTransform = glm::dmat4(1);
    finishScene(plain);
    const Geometry geometry = flatten(plain, plain.startTime);
    for (size_t i = 0; i + 2 < geometry.indices.size(); i += 3) {
        const glm::dvec3 a(geometry.positions[geometry.indices[i]]),
            b(geometry.positions[geometry.indices[i + 1]]), c(geometry.positions[geometry.indices[i + 2]]);
        const glm::dvec3 cross = glm::cross(b - a, c - a);
        const double length = std::sqrt(glm::dot(cross, cross));
        if (length > 0) return {plain.origin + (a + b + c) / 3.0, cross / length};
    }
    return {size.centre, glm::dvec3(0, 1, 0)};
}

void addLight(Scene& scene, const EditLight& added, const Size& size) {
    glm::dvec3 place = size.centre + size.radius * added.place;
    glm::dvec3 target = size.centre;
    if (added.where != EditLight::Where::Place) {
        const auto [point, normal] = firstSurface(scene, size);
        place = added.where == EditLight::Where::OnSurface ? point : point - 1e-3 * size.radius * normal;
        target = point + size.radius * normal;
    }
    Light light;
    light.name = "stress";
    light.kind = added.kind;
    const double distance =
        std::max(std::sqrt(glm::dot(place - size.centre, place - size.centre)), 1e-3 * size.radius);
    const double side = added.size * size.radius;
    double intensity = added.irradiance;
    if (added.kind == LightKind::Point || added.kind == LightKind::Spot) intensity *= distance * distance;
    if (added.kind == LightKind::Sphere) {
        intensity *= distance * distance / (glm::pi<double>() * side * side);
        light.halfSize = glm::vec2(static_cast<float>(side), 0);
    }
    if (added.kind == LightKind::Rectangle) {
        intensity *= distance * distance / (4 * side * side);
        light.halfSize = glm::vec2(static_cast<float>(side));
    }
    light.intensity = static_cast<float>(intensity);
    Node node;
    node.name = "stress light";
    node.translation = place;
    if (glm::dot(target - place, target - place) > 0) node.rotation = builtin::lookRotation(place, target);
    node.light = static_cast<int>(scene.lights.size());
    light.node = static_cast<int>(scene.nodes.size());
    scene.roots.push_back(light.node);
    scene.nodes.push_back(std::move(node));
    scene.lights.push_back(std::move(light));
}

// Keys stand between frames, so that rounding of a frame's time chooses none of two.
void blink(Scene& scene, int frames, const Size& size) {
    Animation animation;
    animation.name = "blink";
    for (const Light& light : scene.lights) {
        if (light.node < 0) continue;
        Node& node = scene.nodes[static_cast<size_t>(light.node)];
        if (node.matrix) continue;
        const bool turns = light.kind == LightKind::Directional;
        AnimationChannel channel;
        channel.node = light.node;
        channel.path = turns ? AnimatedPath::Rotation : AnimatedPath::Translation;
        channel.interpolation = Interpolation::Step;
        const glm::dquat back = node.rotation * glm::angleAxis(glm::pi<double>(), glm::dvec3(1, 0, 0));
        const glm::dvec3 away = node.translation + glm::dvec3(1e4 * size.radius, 0, 0);
        for (int frame = 0; frame <= frames; ++frame) {
            channel.times.push_back(frame == 0 ? 0.0f : static_cast<float>((frame - 0.5) / 60));
            const bool here = frame % 2 == 0;
            if (turns) {
                const glm::dquat q = here ? node.rotation : back;
                for (const double value : {q.x, q.y, q.z, q.w})
                    channel.values.push_back(static_cast<float>(value));
            } else {
                const glm::dvec3 p = here ? node.translation : away;
                for (const double value : {p.x, p.y, p.z})
                    channel.values.push_back(static_cast<float>(value));
            }
        }
        animation.channels.push_back(std::move(channel));
    }
    if (!animation.channels.empty()) scene.animations.push_back(std::move(animation));
}

glm::dmat4 rootOf(const SceneEdit& edit, const Scene& scene, const Size& size) {
    const glm::dvec3 radians = glm::radians(edit.turn);
    glm::dmat4 turned(1);
    const glm::dvec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int axis = 0; axis < 3; ++axis)
        if (radians[axis] != 0) turned = glm::rotate(glm::dmat4(1), radians[axis], axes[axis]) * turned;
    if (edit.mirror) turned = glm::scale(glm::dmat4(1), glm::dvec3(-1, 1, 1)) * turned;
    // The scene's own root may scale it too.
    const double own = std::cbrt(std::abs(glm::determinant(glm::dmat3(scene.rootTransform))));
    const glm::dmat4 scaled = glm::scale(glm::dmat4(1), glm::dvec3(edit.scale));
    return glm::translate(glm::dmat4(1), edit.scale * own * size.radius * edit.move) * scaled * turned;
}

} // namespace

void editScene(Scene& scene, const SceneEdit& edit) {
    if (edit == SceneEdit{}) return;
    const Size size = sizeOf(scene);
    if (edit.dropAnimations) {
        scene.animations.clear();
        for (Camera& camera : scene.cameras)
            if (camera.path.size() > 1) camera.path.resize(1);
    }
    editTriangles(scene, edit);
    if (edit.offCentre != 0) addFarTriangle(scene, edit.offCentre, size);
    editMaterials(scene, edit);
    if (edit.dropLights) {
        for (const Light& light : scene.lights)
            if (light.node >= 0) scene.nodes[static_cast<size_t>(light.node)].light = -1;
        scene.lights.clear();
    }
    for (Light& light : scene.lights) light.intensity *= static_cast<float>(edit.intensity);
    for (const EditLight& light : edit.lights) addLight(scene, light, size);
    if (edit.blinkFrames > 0) blink(scene, edit.blinkFrames, size);
    editCameras(scene, edit, size);
    scene.rootTransform = rootOf(edit, scene, size) * scene.rootTransform;
    finishScene(scene);
}

} // namespace kestrel
