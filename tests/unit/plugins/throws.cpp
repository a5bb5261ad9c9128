// A plugin whose registration fails.
#include "plugin/plugin.h"
#include <stdexcept>

KESTREL_PLUGIN {
    registry.shaderFolders.emplace_back("/nowhere");
    throw std::runtime_error("no luck today");
}
