#include "plugin/plugin.h"
#include "reflective_shadow_map.h"

KESTREL_PLUGIN {
    registry.add(kestrel::ReflectiveShadowMap::type());
}
