// Scenes that are hard on purpose, for `kestrel stress`: geometry, depth complexity, closed rooms. They go by
// "builtin:stress_NAME?count=N" and are in no list of scenes for pictures.
#pragma once
#include "scene/scene.h"
#include <span>
#include <string_view>

namespace kestrel::builtin {

struct StressScene {
    std::string_view name, description; // without "stress_"
    Scene (*make)(int count);           // finishScene() has not been called
    int count;                          // where none is given
    int most;                           // that it takes; 0: it takes none
};

std::span<const StressScene> stressScenes();

} // namespace kestrel::builtin
