// Files: bounded reading, writing through a temporary name, and paths that must not leave a folder.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kestrel {

// No input file may be larger: a stranger's file cannot make the program allocate without bound.
inline constexpr std::uintmax_t maxFileBytes = std::uintmax_t{2} << 30;

// The whole file. Throws InputError naming the file if it is missing, not a plain file, or larger than
// `limit`.
std::vector<std::byte> readBytes(const std::filesystem::path& file, std::uintmax_t limit = maxFileBytes);
std::string readText(const std::filesystem::path& file, std::uintmax_t limit = maxFileBytes);

// A file that the user names: also "-", which is standard input, and pipes and devices, which are read to
// their end. Throws as readBytes() does. Not for what a file from a stranger names.
std::vector<std::byte> readGivenBytes(const std::filesystem::path& file, std::uintmax_t limit = maxFileBytes);
std::string readGivenText(const std::filesystem::path& file, std::uintmax_t limit = maxFileBytes);
// Whether it is read as a stream: "-", a pipe or a device.
bool isStream(const std::filesystem::path& file);

// Writes beside `file`, without a name where the file system allows, then gives it that of `file`: no reader
// ever sees half a file, however the program ends. Makes the parent folder if it lacks. A pipe or a device is
// written as it is, and so is standard output, called "-"; of a symbolic link that to which it leads. Throws
// InputError naming the file and the system's reason; nothing is left behind then.
void writeFile(const std::filesystem::path& file, std::span<const std::byte> bytes);
void writeFile(const std::filesystem::path& file, std::string_view text);

// The same of several files: none has its name before all are whole.
using FileBytes = std::vector<std::pair<std::filesystem::path, std::vector<std::byte>>>;
void writeFiles(const FileBytes& files);

// Throws as writeFile() would, by what can be known before there is anything to write: missing folders are
// made and taken away again. For what takes long before it writes.
void requireWritable(const std::filesystem::path& file);
// The same of a folder that files will be written into.
void requireWritableFolder(const std::filesystem::path& folder);

// The path of `relative` (a URI path from an untrusted file) inside `folder`. Throws InputError if it is
// absolute or leaves the folder, also through a symbolic link.
std::filesystem::path pathInside(const std::filesystem::path& folder, std::string_view relative);

// The folder that holds `shaders` and `graphs`: $KESTREL_SHARE, or share/kestrel beside the folder of
// libkestrel (the same layout in the build tree and when installed). Throws MachineError if there is none.
std::filesystem::path shareFolder();

// The folders of the plugins: `kestrel/` beside libkestrel, then those that $KESTREL_PLUGINS names (separated
// by colons): plugins of others join Kestrel's own.
std::vector<std::filesystem::path> pluginFolders();

} // namespace kestrel
