#include "draw/face_input.h"

namespace kestrel {

void useFaceNormal(Declaration& declaration, Step& step, const Inputs& inputs, Access access) {
    if (!inputs.connected("face_normal")) {
        declaration.leftOut.push_back(
            {"horizon of the faces", "face_normal is not connected: rays end at the horizon of the normal"});
        return;
    }
    step.defines.emplace("FACE_NORMAL", "1");
    step.uses.push_back({.port = "face_normal", .access = access});
}

bool usesFaceNormal(const Step& step) { return step.defines.contains("FACE_NORMAL"); }

} // namespace kestrel
