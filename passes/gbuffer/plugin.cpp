#include "plugin/plugin.h"
#include "gbuffer.h"

KESTREL_PLUGIN { registry.add(kestrel::GBuffer::type()); }
