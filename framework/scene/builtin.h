// Built-in scenes: procedural, deterministic, each with named cameras and what its name promises.
#pragma once
#include "scene/scene.h"
#include <string>
#include <vector>

namespace kestrel {

struct BuiltinInfo {
    std::string name;        // "tower"
    std::string description; // what it shows
};

// Whether `source` starts with "builtin:", whatever follows.
bool isBuiltin(const std::string& source);

// All built-in scenes, in the order of listing.
std::vector<BuiltinInfo> builtinInfos();
std::vector<std::string> builtinNames();

// Builds "builtin:NAME", with properties as "builtin:NAME?detail=D&split=N&extent=E&blended=A". Detail, 0.01
// to 4, default 1, scales the number of triangles: small values serve tests and keep the look. Split, 1 to
// 64, default 1, cuts each triangle into N * N coplanar ones: the same surface in more triangles (scenes with
// a skin cannot be split). Extent, 1 to 1000, default 1, makes the scene the middle of one that is so many
// times larger and otherwise empty, but for four small posts far away. Blended, 0.01 to 1, makes every
// material blended, of that alpha, and seen from both sides. "builtin:stress_NAME?count=N" are the scenes of
// stress cases (builtin/stress_scenes.h), which no list has. finishScene() has not been called on the result.
// Throws InputError with the near name for an unknown scene or key, and for a value out of range.
Scene builtinScene(const std::string& source);

} // namespace kestrel
