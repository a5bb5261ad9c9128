#include "plugin/plugin.h"
#include "constant_tracer.h"

KESTREL_PLUGIN { registry.add(kestrel::ConstantTracer::type()); }
