#include "plugin/plugin.h"
#include "occupancy_map.h"
#include "occupancy_trace.h"
#include "roma.h"
#include "roma_cascade.h"

KESTREL_PLUGIN {
    registry.add(kestrel::OccupancyMap::type());
    registry.add(kestrel::OccupancyTrace::type());
    registry.add(kestrel::Roma::type());
    registry.add(kestrel::RomaCascade::type());
}
