#include "draw/material_defines.h"
#include "shader/compose.h"

namespace kestrel {

Defines materialDefines(const SceneFacts& facts, Blended blended) {
    Defines defines;
    if (facts.hasTextures) {
        defines["MATERIAL_TEXTURES"] = "1";
        defines["MATERIAL_COLOUR_ARRAYS"] = std::to_string(facts.colourTextureArrays);
        defines["MATERIAL_DATA_ARRAYS"] = std::to_string(facts.dataTextureArrays);
        if (facts.hasTiledTextures) defines["MATERIAL_TILED"] = "1";
        if (facts.hasNormalMaps) defines["MATERIAL_NORMAL_MAPS"] = "1";
    }
    if (facts.hasMasked) defines["MATERIAL_MASKED"] = "1";
    constexpr const char* names[] = {"", "BLENDED_KEPT", "BLENDED_ALONE", "BLENDED_LEFT_OUT"};
    if (facts.hasBlend && blended != Blended::Tested) defines.emplace(names[static_cast<int>(blended)], "1");
    if (facts.hasVertexColours) defines["MATERIAL_COLOURS"] = "1";
    return defines;
}

std::map<std::string, std::vector<std::string>> materialDefineChoices() {
    const std::vector<std::string> present = {undefinedChoice, "1"};
    return {{"MATERIAL_TEXTURES", {"1"}},
            {"MATERIAL_COLOUR_ARRAYS", {"0", "1", "4"}},
            {"MATERIAL_DATA_ARRAYS", {"0", "1", "4"}},
            {"MATERIAL_TILED", present},
            {"MATERIAL_NORMAL_MAPS", present},
            {"MATERIAL_MASKED", present},
            {"MATERIAL_COLOURS", present}};
}

} // namespace kestrel
