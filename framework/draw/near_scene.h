// How much of a scene matters to a camera from near: what lengths that "fit the scene" are to be taken from.
// Needs no GL.
#pragma once
#include "scene/facts.h"
#include "scene/geometry.h"

namespace kestrel {

// A camera says by its near plane how near detail matters. A scene of more than this many of them to its edge
// is far wider than what is seen from near.
inline constexpr float wideScene = 1024;
// What is seen from near then: this many of them about a point as far ahead.
inline constexpr float nearSceneReach = 256;

[[nodiscard]] bool isWide(const SceneFacts& facts, const CameraState& camera);

// The scene's bounding sphere; of a wide scene the part that the camera sees from near. Orthographic cameras
// see all of it.
[[nodiscard]] Sphere nearScene(const SceneFacts& facts, const CameraState& camera);

} // namespace kestrel
