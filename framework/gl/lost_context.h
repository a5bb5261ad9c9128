// What becomes of a run when the driver resets the GPU.
#pragma once

namespace kestrel::gl {

// To be called once in a while, as after each frame: from a reset on every call does nothing, and what is
// read back is anything. Throws MachineError saying that the current context is lost, and whose fault the
// driver holds it to be. A driver that tells of no resets (llvmpipe never has one) is taken to have none.
void requireLiveContext();

} // namespace kestrel::gl
