// An OpenGL 4.6 core context: EGL without a surface, OSMesa, or a GLFW window. One at a time is current.
#pragma once
#include "graph/types.h"
#include <memory>
#include <string>

namespace kestrel::gl {

enum class Backend : std::uint8_t { Egl, OsMesa, Window };
// "egl", "osmesa", "window"; InputError with the near name otherwise.
Backend backendFromName(const std::string& name);

struct ContextOptions {
    Backend backend = Backend::Egl;
    Extent windowSize{1280, 720, 1};
    std::string title = "Kestrel";
    bool debug = true; // KHR_debug output goes to the log
};

class Context {
public:
    // Creates the context and makes it current: EGL surfaceless, then EGL on a device. Mesa's software driver
    // has every 4.6 extension and reports 4.5, so MESA_GL_VERSION_OVERRIDE and MESA_GLSL_VERSION_OVERRIDE are
    // set before the first context unless the user has set them, and afterwards each extension that makes
    // up 4.6 is checked. Throws MachineError naming what lacks.
    static std::unique_ptr<Context> create(const ContextOptions& options = {});
    virtual ~Context();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    // On the calling thread, in place of the context that was current, of whatever backend.
    void makeCurrent();
    // Window only: shows the default framebuffer and handles events; false once the user has closed it.
    virtual bool present() { return true; }
    // Pixels of the default framebuffer; {0, 0} where there is none.
    [[nodiscard]] virtual Extent framebufferExtent() const { return {0, 0, 1}; }
    // Window only: the GLFWwindow.
    [[nodiscard]] virtual void* window() const { return nullptr; }

    [[nodiscard]] const Capabilities& capabilities() const { return capabilities_; }
    [[nodiscard]] const std::string& driver() const { return driver_; } // vendor, version
    // How many GL errors of high severity the debug output has told since the program started, of all
    // contexts; tests expect 0. Compiler messages and allocations that fail do not count: they are thrown.
    [[nodiscard]] static std::uint64_t severeErrors();

protected:
    using GetProcAddress = void (*(*)(const char*))();
    Context() = default;
    virtual void bind() = 0;
    virtual void unbind() = 0;
    // Makes the new context current; then functions, requirements, capabilities, debug output, fixed state.
    void finishCreation(GetProcAddress getProcAddress, bool debug);

private:
    // Entry points differ between EGL, OSMesa and the window.
    void loadFunctions() const;
    GetProcAddress getProcAddress_ = nullptr;
    Capabilities capabilities_;
    std::string driver_;
};

// Waits until the GPU is done.
void finish();

} // namespace kestrel::gl
