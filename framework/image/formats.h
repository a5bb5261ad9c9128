// The three file formats, each in its own file. Called by io.cpp only.
#pragma once
#include "image/image.h"
#include "image/io.h"
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace kestrel::detail {

// Decoders throw InputError whose location is `name`; see readPicture for what they give.
Image decodePng(std::span<const std::byte> bytes, const std::string& name);
Image decodeHdr(std::span<const std::byte> bytes, const std::string& name);
Image decodeExr(std::span<const std::byte> bytes, const std::string& name, const std::string& layer);

std::vector<std::byte> encodePng(const Image& image, Encoding encoding);
std::vector<std::byte> encodeHdr(const Image& image);
std::vector<std::byte> encodeExr(const Image& image);

// Throws InputError if an image of this size may not be read.
void requireImageSize(long long width, long long height, long long channels, const std::string& name);

// Throws InputError at `name`. Texts from the file may stand in the message: what is not
// printable becomes '?'.
[[noreturn]] void failImage(const std::string& name, const std::string& message);
std::string printable(std::string text);

// Appends what stb's writers hand over; `context` is a std::vector<std::byte>.
void appendBytes(void* context, void* data, int size);

} // namespace kestrel::detail
