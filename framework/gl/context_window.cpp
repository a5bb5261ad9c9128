#include "core/error.h"
#include "gl/context_backends.h"
#ifdef KESTREL_HAS_WINDOW
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#ifdef KESTREL_SANITIZE
#include <dlfcn.h>
#include <link.h>
#include <string>
#include <vector>
#endif
#endif

namespace kestrel::gl {

#ifndef KESTREL_HAS_WINDOW

std::unique_ptr<Context> createWindowContext(const ContextOptions&) {
    throw MachineError(
        "this build has no window: install libglfw3-dev and build again, or use --backend egl");
}

#else

namespace {

std::string glfwReason() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text == nullptr ? "no reason given" : text;
}

#ifdef KESTREL_SANITIZE
// What libraries leak is left out by their names (tests/sanitize.supp), which nobody knows once they are
// gone: GLFW lets go of the window system's, and with them of the driver.
void keepLibraries() {
    std::vector<std::string> names;
    dl_iterate_phdr(
        [](dl_phdr_info* info, std::size_t, void* to) {
            static_cast<std::vector<std::string>*>(to)->emplace_back(info->dlpi_name);
            return 0;
        },
        &names);
    for (const std::string& name : names)
        if (!name.empty()) dlopen(name.c_str(), RTLD_LAZY | RTLD_NOLOAD | RTLD_NODELETE);
}
#endif

class WindowContext final : public Context {
public:
    explicit WindowContext(const ContextOptions& options) {
        if (glfwInit() == GLFW_FALSE)
            throw MachineError(fmt::format(
                "no window system ({}): set DISPLAY, or use --backend egl to render without a window",
                glfwReason()));
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 6);
        glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
#ifdef KESTREL_DEBUG
        glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, GLFW_TRUE);
#endif
        window_ = glfwCreateWindow(static_cast<int>(options.windowSize.width),
                                   static_cast<int>(options.windowSize.height), options.title.c_str(),
                                   nullptr, nullptr);
        if (window_ == nullptr) {
            const std::string reason = glfwReason();
            glfwTerminate();
            throw MachineError(fmt::format(
                "no window with an OpenGL 4.6 core context ({}): install libgl1-mesa-dri", reason));
        }
        try {
            finishCreation(glfwGetProcAddress, options.debug);
#ifdef KESTREL_SANITIZE
            keepLibraries();
#endif
        } catch (...) {
            close();
            throw;
        }
    }
    ~WindowContext() override { close(); }
    WindowContext(const WindowContext&) = delete;
    WindowContext& operator=(const WindowContext&) = delete;

    bool present() override {
        glfwSwapBuffers(window_);
        glfwPollEvents();
        return glfwWindowShouldClose(window_) == GLFW_FALSE;
    }

    [[nodiscard]] Extent framebufferExtent() const override {
        int width = 0;
        int height = 0;
        glfwGetFramebufferSize(window_, &width, &height);
        return {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), 1};
    }

    [[nodiscard]] void* window() const override { return window_; }

protected:
    void bind() override { glfwMakeContextCurrent(window_); }
    void unbind() override { glfwMakeContextCurrent(nullptr); }

private:
    void close() {
        glfwDestroyWindow(window_);
        glfwTerminate();
    }

    GLFWwindow* window_ = nullptr;
};

} // namespace

std::unique_ptr<Context> createWindowContext(const ContextOptions& options) {
    return std::make_unique<WindowContext>(options);
}

#endif

} // namespace kestrel::gl
