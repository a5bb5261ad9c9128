#include "plugin/plugin.h"
#include "composite.h"
#include "direct_light.h"
#include "environment.h"
#include "radiance_sum.h"
#include "reflective_shadow_map.h"
#include "rsm_gather.h"

KESTREL_PLUGIN {
    registry.add(kestrel::Composite::type());
    registry.add(kestrel::DirectLight::type());
    registry.add(kestrel::Environment::type());
    registry.add(kestrel::RadianceSum::type());
    registry.add(kestrel::ReflectiveShadowMap::type());
    registry.add(kestrel::RsmGather::type());
}
