#include "plugin/plugin.h"
#include "ambient_occlusion_first.h"
#include "ambient_occlusion_refine.h"
#include "hbao_interleaved.h"
#include "horizon_ambient_occlusion.h"
#include "ray_ambient_occlusion.h"

KESTREL_PLUGIN {
    registry.add(kestrel::AmbientOcclusionFirst::type());
    registry.add(kestrel::AmbientOcclusionRefine::type());
    registry.add(kestrel::HbaoInterleaved::type());
    registry.add(kestrel::HorizonAmbientOcclusion::type());
    registry.add(kestrel::RayAmbientOcclusion::type());
}
