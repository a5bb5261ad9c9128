// The faces in which a light sees the scene: what its shadow map holds, as numbers and as cameras. Needs no
// GL.
#pragma once
#include "scene/facts.h"
#include "scene/geometry.h"
#include <cstdint>

namespace kestrel {

// How many faces: 0 stands for one of parallel rays, 1 for a cone, 5 for the half space before a rectangle or
// a wide cone (wideSpotCone), 6 for all directions. How they lie is said in shared/light_map.h.
std::uint32_t lightFaces(const LightState& light);

// One face of a light over a scene of that bounding sphere.
struct LightFaces {
    glm::vec3 origin{0}; // where the rays meet, or the middle of the plane that parallel rays start from
    float halfWidth = 1; // tangent of half a face's angle, or half the width of parallel rays in scene units
    float nearPlane = 0; // nothing nearer is seen; 0 of parallel rays
    float farPlane = 0;  // 0: infinite
};
LightFaces lightFacesOver(const LightState& light, const Sphere& scene);

// The face as a camera. Faces 2, 4 and 5 of a map are mirror images; a camera never is: it has their right on
// its left. Throws InputError if the light has no such face.
CameraState lightCamera(const LightState& light, int face, const Sphere& scene);

} // namespace kestrel
