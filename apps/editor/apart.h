// Whether memory that is shared is to blame for a picture.
#pragma once
#include "session.h"
#include <string>

namespace kestrel::edit {

// Gives a resource memory of its own, or takes it back, and renders the picture of `seen` anew before and
// after: a sentence that says whether it is the same to the bit. Nothing else changes, so that another
// picture is the fault of a pass that reads what it did not write, or of the plan.
std::string toggleApart(Session& session, const PortRef& resource, const PortRef& seen);

} // namespace kestrel::edit
