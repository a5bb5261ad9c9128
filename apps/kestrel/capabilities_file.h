// Capabilities as a file: what a machine elsewhere can do, for `check --capabilities`.
#pragma once
#include "graph/types.h"
#include <filesystem>
#include <string>

namespace kestrel {

// Reads a JSON object with any of the members that capabilitiesJson writes; what is missing is the minimum of
// OpenGL 4.6. Throws InputError with every mistake and its place.
Capabilities readCapabilities(const std::filesystem::path& file);
std::string capabilitiesJson(const Capabilities& capabilities);

} // namespace kestrel
