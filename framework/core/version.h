// What this build of Kestrel is.
#pragma once
#include <string>

namespace kestrel {

std::string version();       // "0.1.0"
std::string configuration(); // "release", "debug" or "sanitize"
std::string parts(); // the optional parts that are in, separated by spaces: "egl osmesa window embree3"

} // namespace kestrel
