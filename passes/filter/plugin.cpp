#include "plugin/plugin.h"
#include "accumulate.h"
#include "bilateral_blur.h"

KESTREL_PLUGIN {
    registry.add(kestrel::Accumulate::type());
    registry.add(kestrel::BilateralBlur::type());
}
