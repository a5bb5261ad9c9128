#include "plugin/plugin.h"
#include "accumulate.h"
#include "bilateral_blur.h"
#include "spatiotemporal_filter.h"
#include "temporal_aa.h"

KESTREL_PLUGIN {
    registry.add(kestrel::Accumulate::type());
    registry.add(kestrel::BilateralBlur::type());
    registry.add(kestrel::SpatiotemporalFilter::type());
    registry.add(kestrel::TemporalAa::type());
}
