// Lets one text be a C++ header and a GLSL include: GLSL's type names in C++, C++'s keywords as nothing in GLSL.
// Shared headers put their declarations between SHARED_BEGIN and SHARED_END (namespace kestrel::shared in C++).
#pragma once
#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
#define SHARED_BEGIN namespace kestrel::shared {
#define SHARED_END }
#define OUT(type) type&
#define INOUT(type) type&
namespace kestrel::shared {
using glm::ivec2, glm::ivec3, glm::ivec4, glm::uvec2, glm::uvec3, glm::uvec4, glm::vec2, glm::vec3, glm::vec4;
using glm::mat3, glm::mat4, glm::abs, glm::clamp, glm::cross, glm::dot, glm::floor, glm::max, glm::min, glm::sqrt;
using glm::inversesqrt, glm::length, glm::normalize, glm::sign, glm::sin, glm::cos, glm::mix;
using uint = std::uint32_t;
} // namespace kestrel::shared
#else
#define inline
#define SHARED_BEGIN
#define SHARED_END
#define OUT(type) out type
#define INOUT(type) inout type
#endif
