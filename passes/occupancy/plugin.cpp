#include "plugin/plugin.h"
#include "occupancy_map.h"
#include "roma.h"

KESTREL_PLUGIN {
    registry.add(kestrel::OccupancyMap::type());
    registry.add(kestrel::Roma::type());
}
