// KHR_debug: what the driver says goes to the log; GL errors of high severity are counted.
#pragma once
#include <cstdint>

namespace kestrel::gl {

// Of the current context; messages come from within the call that causes them.
void enableDebugOutput();

std::uint64_t severeErrorCount();

// Opens a named group (also seen by GPU debuggers) while it lives.
class DebugGroup {
public:
    explicit DebugGroup(const char* name);
    ~DebugGroup();
    DebugGroup(const DebugGroup&) = delete;
    DebugGroup& operator=(const DebugGroup&) = delete;
};

} // namespace kestrel::gl
