#include "plugin/plugin.h"
#include "hemisphere_rays.h"
#include "hit_count.h"
#include "ray_query.h"

KESTREL_PLUGIN {
    registry.add(kestrel::HemisphereRays::type());
    registry.add(kestrel::HitCount::type());
    registry.add(kestrel::RayQuery::type());
}
