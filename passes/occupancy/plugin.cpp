#include "plugin/plugin.h"
#include "occupancy_map.h"
#include "occupancy_trace.h"
#include "roma.h"

KESTREL_PLUGIN {
    registry.add(kestrel::OccupancyMap::type());
    registry.add(kestrel::OccupancyTrace::type());
    registry.add(kestrel::Roma::type());
}
