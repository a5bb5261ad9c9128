// KHR_debug: what the driver says goes to the log; GL errors of high severity are counted.
#pragma once
#include <cstdint>
#include <string_view>

namespace kestrel::gl {

// Of the current context; messages come from within the call that causes them.
void enableDebugOutput();

std::uint64_t severeErrorCount();

// Names an object for debuggers; `kind` as GL_BUFFER, GL_TEXTURE… A text that is longer than the driver takes
// is cut, between two characters.
void setLabel(unsigned int kind, unsigned int name, std::string_view text);
// Opens a debug group (glPopDebugGroup() closes it), whose text is cut likewise.
void pushDebugGroup(unsigned int id, std::string_view text);
// The first `most` bytes of a UTF-8 text, or fewer where those would end within a character.
std::string_view cutText(std::string_view text, std::size_t most);

} // namespace kestrel::gl
