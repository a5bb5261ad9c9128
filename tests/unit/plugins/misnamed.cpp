// A plugin that registers a pass type with an impossible port name.
#include "plugin/plugin.h"

KESTREL_PLUGIN {
    kestrel::PassType type;
    type.name = "Misnamed";
    type.ports.push_back({"Result", kestrel::PortKind::Texture, kestrel::PortDirection::Output, false, ""});
    registry.add(type);
}
