#include "plugin/plugin.h"
#include "depth_peeling.h"
#include "k_buffer.h"
#include "transparent_composite.h"
#include "weighted_blended.h"

KESTREL_PLUGIN {
    registry.add(kestrel::DepthPeeling::type());
    registry.add(kestrel::KBuffer::type());
    registry.add(kestrel::TransparentComposite::type());
    registry.add(kestrel::WeightedBlended::type());
}
