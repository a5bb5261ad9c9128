#include "plugin/plugin.h"
#include "debug_view.h"
#include "error_measure.h"
#include "image_file.h"
#include "tone_map.h"

KESTREL_PLUGIN {
    registry.add(kestrel::DebugView::type());
    registry.add(kestrel::ErrorMeasure::type());
    registry.add(kestrel::ImageFile::type());
    registry.add(kestrel::ToneMap::type());
}
