// Joints and weights of a vertex.
#pragma once
#include <glm/glm.hpp>

namespace kestrel {

// One entry a joint, as glTF 2.0 (3.7.3.3) asks: the weights of a joint that is named several times are
// summed in its first entry; entries without weight name joint 0. The vertex moves as before.
inline void mergeJoints(glm::uvec4& joints, glm::vec4& weights) {
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < i; ++k)
            if (joints[k] == joints[i] && weights[k] > 0) {
                weights[k] += weights[i];
                weights[i] = 0;
            }
    for (int i = 0; i < 4; ++i)
        if (weights[i] == 0) joints[i] = 0;
}

} // namespace kestrel
