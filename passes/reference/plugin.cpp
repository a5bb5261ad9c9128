#include "plugin/plugin.h"
#include "reference_ambient_occlusion.h"
#include "reference_glossy_reflection.h"
#include "reference_indirect_diffuse.h"
#include "reference_path_trace.h"
#include "reference_ray_query.h"
#include "reference_soft_shadow.h"
#include "reference_transparency.h"

KESTREL_PLUGIN {
    registry.add(kestrel::ReferenceAmbientOcclusion::type());
    registry.add(kestrel::ReferenceGlossyReflection::type());
    registry.add(kestrel::ReferenceIndirectDiffuse::type());
    registry.add(kestrel::ReferencePathTrace::type());
    registry.add(kestrel::ReferenceRayQuery::type());
    registry.add(kestrel::ReferenceSoftShadow::type());
    registry.add(kestrel::ReferenceTransparency::type());
}
