#include "plugin/plugin.h"
#include "near_far_tracer.h"
#include "screen_trace.h"

KESTREL_PLUGIN {
    registry.add(kestrel::NearFarTracer::type());
    registry.add(kestrel::ScreenTrace::type());
}
