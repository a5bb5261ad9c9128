#include "plugin/plugin.h"
#include "distance_field.h"

KESTREL_PLUGIN { registry.add(kestrel::DistanceField::type()); }
