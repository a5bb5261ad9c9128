// Which names of files are standard output.
#pragma once
#include <filesystem>

namespace kestrel {

// "-", and what the system calls it: "/dev/stdout", "/dev/fd/1".
bool isStandardOutput(const std::filesystem::path& file);

} // namespace kestrel
