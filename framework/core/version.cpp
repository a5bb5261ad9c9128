#include "core/version.h"

namespace kestrel {

std::string version() { return KESTREL_VERSION; }
std::string configuration() { return KESTREL_CONFIG_NAME; }
std::string parts() { return KESTREL_PARTS; }

} // namespace kestrel
