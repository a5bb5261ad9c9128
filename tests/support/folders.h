// Where the tree and its build lie.
#pragma once
#include <filesystem>

namespace kestrel::test {

std::filesystem::path sourceFolder(); // the repository's root
std::filesystem::path buildFolder();

} // namespace kestrel::test
