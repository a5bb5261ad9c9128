// What the allocator does with large buffers that are freed.
#pragma once

namespace kestrel {

// Keeps freed memory in the process, for what the next frame asks for again: geometry, hierarchies, pictures.
// The C library's default hands large blocks back to the system at once, whose pages then come anew, cleared,
// one fault each; building a hierarchy in each frame took 2 to 3 times as long so, on a virtual machine. Call
// it first; does nothing where the C library has no such setting.
void keepFreedMemory();

} // namespace kestrel
