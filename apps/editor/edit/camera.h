// A camera that one moves: what --camera says (scene/setup.h), flown and turned. No GL.
#pragma once
#include "scene/geometry.h"
#include "scene/setup.h"
#include <string>

namespace kestrel::edit {

// The camera that looks as `state` does in a scene, with y up, near and infinitely far; its target lies where
// the way of looking passes the middle of the scene, at most 1e4 near planes away. What is orthographic
// becomes a perspective of 45 degrees.
AddedCamera cameraFrom(const CameraState& state, const Scene& scene);

// What the camera sees in the scene: the same as with --camera cameraOption(camera), to the bit.
CameraState stateOf(const AddedCamera& camera, const Scene& scene);

// "eye=4,3,6 target=0,1,0 fov=50 near=0.05", as --camera takes it.
std::string cameraOption(const AddedCamera& camera);

// Every move rounds to five digits of the distance to the target, so that the text stays short, and keeps the
// near plane at most a hundredth of that distance.
void orbit(AddedCamera& camera, double right, double up);      // about the target, radians; never over a pole
void lookAround(AddedCamera& camera, double right, double up); // about the eye, radians
void dolly(AddedCamera& camera, double factor);                // the distance to the target, times
void fly(AddedCamera& camera, const glm::dvec3& by); // right, up, forward, in distances to the target

} // namespace kestrel::edit
