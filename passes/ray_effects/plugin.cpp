#include "plugin/plugin.h"
#include "glossy_reflection.h"
#include "hemisphere_rays.h"
#include "hit_count.h"
#include "indirect_diffuse.h"
#include "path_trace.h"
#include "ray_query.h"
#include "soft_shadow.h"

KESTREL_PLUGIN {
    registry.add(kestrel::GlossyReflection::type());
    registry.add(kestrel::HemisphereRays::type());
    registry.add(kestrel::HitCount::type());
    registry.add(kestrel::IndirectDiffuse::type());
    registry.add(kestrel::PathTrace::type());
    registry.add(kestrel::RayQuery::type());
    registry.add(kestrel::SoftShadow::type());
}
