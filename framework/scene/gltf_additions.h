// What glTF files hold that this version of Kestrel does not know: additions of later versions and of
// extensions.
#pragma once
#include "scene/gltf_container.h"

namespace kestrel {

// Takes out of the document, before its schema is checked, what is of a kind that Kestrel does not know, so
// that the rest can be used: cameras and lights of another type (and the references to them), alpha modes.
// Each is named in a warning. Accessors of another element or component type are noted in
// GltfFile::unreadable: whether the file can do without them is for their users to say. Touches nothing of
// the wrong JSON type: the schema check tells that.
void setAsideAdditions(GltfFile& file);

} // namespace kestrel
