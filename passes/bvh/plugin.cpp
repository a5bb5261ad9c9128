#include "plugin/plugin.h"
#include "bvh_pass.h"

KESTREL_PLUGIN { registry.add(kestrel::BvhPass::type()); }
