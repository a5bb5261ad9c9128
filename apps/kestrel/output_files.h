// Which outputs go into which files, and how a port's content becomes a file.
#pragma once
#include "execute/renderer.h"
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace kestrel {

struct OutputFile {
    PortRef port;
    std::filesystem::path file;
};

// "pass.port=FILE". Throws InputError for another form, and for a file ending that is none of .png, .hdr,
// .exr and .bin.
OutputFile parseOutput(const std::string& text);

// Files to be written, as bytes: nothing is written before everything has been made.
using FileBytes = std::vector<std::pair<std::filesystem::path, std::vector<std::byte>>>;

// The file of one port. PNG: one and two channels as they are; three and four as sRGB without alpha, unless
// the port holds display values already. HDR and EXR: the values. .bin: the raw bytes of a buffer or texture.
// Layers stand below each other. Throws InputError where a buffer is asked for as an image.
void addOutput(FileBytes& files, Renderer& renderer, const Registry& registry, const OutputFile& output);

// The graph's outputs under their names: `folder`/pass.port.png, beside it an .exr where a PNG would cut
// values off, and .bin for buffers.
void addGraphOutputs(FileBytes& files, Renderer& renderer, const Registry& registry,
                     const std::filesystem::path& folder);

// Writes all; if one fails, those that were written are taken away again.
void writeAll(const FileBytes& files);

} // namespace kestrel
