#include "plugin/plugin.h"
#include "abuffer.h"
#include "abuffer_bounds.h"
#include "abuffer_reorder.h"
#include "abuffer_store.h"

KESTREL_PLUGIN {
    registry.add(kestrel::ABuffer::type());
    registry.add(kestrel::ABufferBounds::type());
    registry.add(kestrel::ABufferReorder::type());
    registry.add(kestrel::ABufferStore::type());
}
