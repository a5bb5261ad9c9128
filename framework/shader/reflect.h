// What a composed program binds, by name: for tests that C++ and GLSL agree on blocks, and that every
// resource of a shader is bound by something. Made by glslang; needs no GL context.
#pragma once
#include "shader/compose.h"
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace kestrel {

// A member of a block, in bytes from the block's begin. Members of struct members are listed one by one
// ("light.colour", "lights[0].colour": for an array of structs the first element stands for all).
struct BlockMember {
    std::string name;
    std::string type;       // as in GLSL, without array brackets: "vec3", "mat4", "uint"
    std::size_t offset = 0; // bytes
    int arraySize = 0; // elements; 0: not an array; -1: sized by the buffer (last member of a storage block)
    int arrayStride = 0;    // bytes from element to element; 0: not an array
    int topLevelStride = 0; // bytes from struct to struct if it lies in an array of structs, else 0
    friend bool operator==(const BlockMember&, const BlockMember&) = default;
};

struct ShaderResource {
    enum Kind { Uniform, Sampler, Image, UniformBlock, StorageBlock };
    Kind kind = Uniform;
    std::string name;     // what GL binds by: for blocks the block's name, not the instance's
    std::string type;     // "vec4", "sampler2D", "uimage3D"; for blocks the block's name
    std::string format;   // of images: "r32ui"; else empty
    std::size_t size = 0; // bytes of a block without its unsized last array; 0 for the others
    int arraySize = 0;    // elements of an array of samplers, images, blocks or uniforms; 0: not an array
    std::vector<BlockMember> members; // of blocks, by offset
    std::vector<ShaderStage> stages;  // those that use it, in pipeline order

    // Null if there is none of that name.
    [[nodiscard]] const BlockMember* member(std::string_view member) const;
};

// The resources that the program uses, by name. What no stage reaches from its main() is not listed: drivers
// drop it too.
struct Reflection {
    std::vector<ShaderResource> resources;
    std::array<int, 3> localSize{}; // of a compute program; zero otherwise

    // Null if there is none of that name.
    [[nodiscard]] const ShaderResource* find(std::string_view name) const;
};

// Throws InputError with the problems of validate() if the program does not compile, and one that names the
// extension if glslang does not know the program (glslangKnows).
Reflection reflect(const ComposedProgram& program);

} // namespace kestrel
