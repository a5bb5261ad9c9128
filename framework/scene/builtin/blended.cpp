#include "scene/builtin/blended.h"

namespace kestrel::builtin {

void blend(Scene& scene, float alpha) {
    for (Material& material : scene.materials) {
        material.alphaMode = AlphaMode::Blend;
        material.baseColour.a *= alpha;
        material.doubleSided = true;
    }
}

} // namespace kestrel::builtin
