// Which outputs go into which files, and how a port's content becomes a file.
#pragma once
#include "core/files.h"
#include "execute/renderer.h"
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace kestrel {

struct OutputFile {
    enum class Kind { Png, Hdr, Exr, Raw };
    PortRef port;
    std::filesystem::path file; // with "%d" or "%0Nd" in its name where every frame has a file of its own
    Kind kind = Kind::Png;
    bool sequence = false;
};

// "pass.port=FILE"; the ending says the kind: .png, .hdr, .exr, .bin. FILE may be "-" (standard output; a
// PNG, or what "exr:-" names) and a pipe or device, which is a PNG where it has no ending. Throws InputError
// for another form, and for a '%' in the name that begins no frame's number and is not doubled.
OutputFile parseOutput(const std::string& text);

// The file of one frame of a sequence; of another output `file`.
std::filesystem::path fileOf(const OutputFile& output, std::uint32_t frame);

// The file of one port, to be written once everything has been made. PNG: one and two channels as they are;
// three and four as sRGB without alpha, unless the port holds display values already. HDR and EXR: the
// values. .bin: the raw bytes of a buffer or texture. Layers stand below each other. Throws InputError where
// a buffer is asked for as an image.
void addOutput(FileBytes& files, Renderer& renderer, const Registry& registry, const OutputFile& output);

// The graph's outputs under their names: `folder`/pass.port.png, beside it an .exr where a PNG would cut
// values off, and .bin for buffers. `mark` stands before the ending: ".0007".
void addGraphOutputs(FileBytes& files, Renderer& renderer, const Registry& registry,
                     const std::filesystem::path& folder, const std::string& mark = {});

} // namespace kestrel
