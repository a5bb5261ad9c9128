// Which names a shader may use: GLSL reserves some, and composition a few more.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace kestrel {

// Why `name` cannot be the name of a port or a define, as the end of a sentence; empty if it can.
std::string whyNotAName(std::string_view name);

// What is wrong with the names in a code line without comments: one sentence each.
std::vector<std::string> nameProblems(std::string_view code);

} // namespace kestrel
