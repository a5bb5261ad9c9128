// One file knows the folders, so that no other is compiled anew where they change.
#include "support/folders.h"

namespace kestrel::test {

std::filesystem::path sourceFolder() { return KESTREL_SOURCE_DIR; }
std::filesystem::path buildFolder() { return KESTREL_BINARY_DIR; }

} // namespace kestrel::test
