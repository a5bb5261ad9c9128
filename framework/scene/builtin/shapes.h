// Meshes of the built-in scenes. Every function adds to a primitive: positions, unit normals, texture
// coordinates and counter-clockwise triangles. Lengths in the scene's unit; y is up.
#pragma once
#include "scene/scene.h"
#include <functional>
#include <glm/glm.hpp>
#include <numbers>
#include <vector>

namespace kestrel::builtin {

inline constexpr float pi = std::numbers::pi_v<float>;

// A point of a surface; u and v from 0 to 1. The front is the side of cross(d/du, d/dv).
using SurfaceFunction = std::function<glm::vec3(float u, float v)>;

struct GridOptions {
    bool closedU = false, closedV = false; // the last column (row) is the first one
    glm::vec2 texScale{1};
    bool flat = false; // one normal a face instead of smooth ones
};

// A surface of nu by nv cells of two triangles with smooth normals. Cells that collapse to a line (at a pole)
// lose their degenerate triangle.
void addGrid(Primitive& to, int nu, int nv, const SurfaceFunction& surface, const GridOptions& options = {});

// A sphere made of the six sides of a cube with n by n cells each, displaced: `place` maps a unit direction
// to a point. Smooth normals, also across the sides.
void addCubeSphere(Primitive& to, int n, const std::function<glm::vec3(const glm::vec3&)>& place);

// A parallelogram from `corner` along two edges; the front is cross(u, v). Texture coordinates run to
// texScale.
void addQuad(Primitive& to, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v,
             const glm::vec2& texScale = glm::vec2(1), int nu = 1, int nv = 1);

// A box around the origin of `frame`. Texture coordinates are metres times texPerUnit.
void addBox(Primitive& to, const glm::mat4& frame, const glm::vec3& halfSize, float texPerUnit = 1);

// A body of revolution around the y axis of `frame`: `profile` holds (radius, height) from bottom to top.
// Corners of the profile sharper than 40 degrees stay sharp.
void addLathe(Primitive& to, const glm::mat4& frame, const std::vector<glm::vec2>& profile, int sides);

// A round bar along `path` with a radius at each point; ends are closed by flat caps.
void addTube(Primitive& to, const std::vector<glm::vec3>& path, const std::vector<float>& radii, int sides);

// Replaces the normals of the vertices from `firstVertex` on by the area-weighted mean over all triangles
// from `firstIndex` on that meet in exactly that position.
void smoothNormals(Primitive& primitive, size_t firstVertex = 0, size_t firstIndex = 0);

// Catmull-Rom spline through `points` (at least 2), t from 0 to 1.
glm::vec3 splinePoint(const std::vector<glm::vec3>& points, float t);

} // namespace kestrel::builtin
