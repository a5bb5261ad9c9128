// KHR_debug: what the driver says goes to the log; GL errors of high severity are counted.
#pragma once
#include <cstdint>

namespace kestrel::gl {

// Of the current context; messages come from within the call that causes them.
void enableDebugOutput();

std::uint64_t severeErrorCount();

} // namespace kestrel::gl
