// State of a draw call. Everything that is not said here is set to the stated default before each draw.
#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

namespace kestrel {

enum class Compare : std::uint8_t { Always, Greater, GreaterEqual, Equal, Less };
enum class Cull : std::uint8_t { None, Back, Front };
// Min and Max: of each channel the smaller or the larger of what is there and what is drawn. MaxAndSum: the
// larger of each colour channel, and the sum of alpha.
enum class Blend : std::uint8_t { None, Add, Over, Min, Max, MaxAndSum };

struct DrawState {
    Compare depth = Compare::Greater; // depth is reversed: nearer is greater
    bool depthWrite = true;
    Cull cull = Cull::Back; // of single-sided classes only; double-sided ones are never culled
    Blend blend = Blend::None;
    bool colourWrite = true;
    bool logicOr = false; // glLogicOp(GL_OR) on integer attachments
    bool depthClamp = false;
    std::optional<glm::uvec2> viewport = {}; // without attachments: the size of the rasterized area
    // Without attachments: the size of a second one, which shaders choose by gl_ViewportIndex 1.
    std::optional<glm::uvec2> secondViewport = {};
    // drawScene without vertex attributes: gl_VertexID / 3 is the triangle's number, its rest the corner.
    bool byNumber = false;
    std::uint32_t instances = 1; // how often drawScene draws each triangle (gl_InstanceID)

    static DrawState overwrite() {
        return {.depth = Compare::Always, .depthWrite = false, .cull = Cull::None};
    }
};

} // namespace kestrel
