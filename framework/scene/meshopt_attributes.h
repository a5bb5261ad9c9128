// The attribute streams of KHR_meshopt_compression, version 1, and its colour filter: newer than the packaged
// meshoptimizer, which reads version 0. Source: the extension's appendices A and B.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace kestrel {

// Whether the stream says that it is of version 1.
bool isMeshoptAttributes1(std::span<const std::byte> stream);

// Decodes `count` elements of `stride` bytes (a multiple of 4, up to 256) into `out`, which has room for
// them. False for a stream that is broken or of another length: `out` may be partly written then.
bool decodeMeshoptAttributes1(std::span<const std::byte> stream, size_t count, size_t stride, std::byte* out);

// Filter COLOR, in place: `count` elements of `stride` bytes (4: 8-bit components, 8: 16-bit) from Y, Co, Cg
// and alpha to red, green, blue and alpha.
void decodeMeshoptColours(std::byte* elements, size_t count, size_t stride);

} // namespace kestrel
