#include "plugin/plugin.h"
#include "adaptive_stochastic_depth.h"
#include "second_depth_layer.h"
#include "stochastic_depth_raster.h"
#include "stochastic_depth_ray.h"

KESTREL_PLUGIN {
    registry.add(kestrel::AdaptiveStochasticDepth::type());
    registry.add(kestrel::SecondDepthLayer::type());
    registry.add(kestrel::StochasticDepthRaster::type());
    registry.add(kestrel::StochasticDepthRay::type());
}
