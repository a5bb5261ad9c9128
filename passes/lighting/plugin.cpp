#include "plugin/plugin.h"
#include "radiance_sum.h"
#include "reflective_shadow_map.h"

KESTREL_PLUGIN {
    registry.add(kestrel::RadianceSum::type());
    registry.add(kestrel::ReflectiveShadowMap::type());
}
