#include "plugin/plugin.h"
#include "ray_ambient_occlusion.h"

KESTREL_PLUGIN { registry.add(kestrel::RayAmbientOcclusion::type()); }
