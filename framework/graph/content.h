// What ports carry beyond their kind: stated in the table of a pass type, held by validate() and compile(),
// told by `kestrel passes`, the schema and editors.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace kestrel {

// What the numbers of a texture or the coordinates in a buffer are measured in.
enum class Space : std::uint8_t {
    Any,    // no place, direction or depth; or whatever comes
    Device, // reversed depth of the rasterizer: 1 at the near plane, 0 at infinity or where nothing is
    View,   // distance along the view axis, scene units
    Render, // positions and directions about the frame's render origin (scene/view.h), scene units
    Screen, // pixels of the frame
    Display // sRGB code values: written to 8-bit files as they are
};
[[nodiscard]] std::string_view spaceName(Space space); // "any", "device"…

// An input takes what is stated at least, an output gives it; what is not stated is not held against
// anything.
struct Content {
    // Of a buffer: the struct of its elements, as it is called in shaders/shared/. An input that states one
    // takes only that.
    std::string structure = {};
    int channels = 0; // of a texture, at least; 0: not stated
    Space space = Space::Any;
    friend bool operator==(const Content&, const Content&) = default;
};

namespace content {
inline const Content depth{.channels = 1, .space = Space::Device};
inline const Content viewDepth{.channels = 1, .space = Space::View};
inline const Content normal{.channels = 3, .space = Space::Render};
inline const Content position{.channels = 3, .space = Space::Render};
inline const Content motion{.channels = 2, .space = Space::Screen};
inline const Content colour{.channels = 3};   // linear light or reflectance
inline const Content material{.channels = 3}; // roughness, metallic, unlit
inline Content elements(std::string structure) { return {.structure = std::move(structure)}; }
} // namespace content

// Why what an output carries is not what an input takes: the rest of a sentence that begins with "carries";
// empty if it is.
[[nodiscard]] std::string contentMistake(const Content& given, const Content& taken);

// "RayRecord elements", "3 channels, render space"; empty where nothing is stated.
[[nodiscard]] std::string describe(const Content& content);

} // namespace kestrel
