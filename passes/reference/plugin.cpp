#include "plugin/plugin.h"
#include "reference_ambient_occlusion.h"

KESTREL_PLUGIN { registry.add(kestrel::ReferenceAmbientOcclusion::type()); }
