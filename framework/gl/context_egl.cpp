#include "core/error.h"
#include "core/log.h"
#include "gl/context_backends.h"
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>
#include <fmt/format.h>
#include <string_view>
#include <vector>

namespace kestrel::gl {
namespace {

#define KESTREL_EGL_FUNCTIONS(X)                                                                             \
    X(eglGetError)                                                                                           \
    X(eglQueryString)                                                                                        \
    X(eglInitialize)                                                                                         \
    X(eglTerminate)                                                                                          \
    X(eglBindAPI)                                                                                            \
    X(eglCreateContext)                                                                                      \
    X(eglDestroyContext)                                                                                     \
    X(eglMakeCurrent)                                                                                        \
    X(eglGetProcAddress)

// libEGL, loaded when first needed: a machine without it can still do all that needs no GL.
struct Egl {
#define X(name) decltype(&::name) name = nullptr;
    KESTREL_EGL_FUNCTIONS(X)
#undef X
    PFNEGLGETPLATFORMDISPLAYEXTPROC getPlatformDisplay = nullptr;

    static const Egl& get() {
        static const Egl instance;
        return instance;
    }

private:
    Egl() {
        void* library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
        if (library == nullptr)
            throw MachineError(fmt::format(
                "libEGL.so.1 cannot be loaded ({}): install libegl1 and libgl1-mesa-dri", dlerror()));
#define X(name)                                                                                              \
    name = reinterpret_cast<decltype(&::name)>(dlsym(library, #name));                                       \
    if (name == nullptr) throw MachineError("libEGL.so.1 has no " #name ": install libegl1");
        KESTREL_EGL_FUNCTIONS(X)
#undef X
        getPlatformDisplay =
            reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
        if (getPlatformDisplay == nullptr)
            throw MachineError("libEGL.so.1 lacks EGL_EXT_platform_base, without which there is no headless "
                               "display: install a newer libegl1");
    }
};

bool lists(const char* extensions, std::string_view name) {
    const std::string text = " " + std::string(extensions == nullptr ? "" : extensions) + " ";
    return text.find(" " + std::string(name) + " ") != std::string::npos;
}

// A way to a display that needs no window system.
struct Candidate {
    std::string name;
    EGLDisplay display = EGL_NO_DISPLAY;
};

std::vector<Candidate> candidates(const Egl& egl) {
    std::vector<Candidate> result;
    const char* client = egl.eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (lists(client, "EGL_MESA_platform_surfaceless"))
        result.push_back({"surfaceless", egl.getPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA,
                                                                EGL_DEFAULT_DISPLAY, nullptr)});
    const auto queryDevices =
        reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(egl.eglGetProcAddress("eglQueryDevicesEXT"));
    if (queryDevices != nullptr && lists(client, "EGL_EXT_platform_device")) {
        EGLDeviceEXT devices[16];
        EGLint count = 0;
        if (queryDevices(16, devices, &count) == EGL_FALSE) count = 0;
        for (EGLint i = 0; i < count; ++i)
            result.push_back({fmt::format("device {}", i),
                              egl.getPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr)});
    }
    return result;
}

class EglContext final : public Context {
public:
    // Throws MachineError with the step that failed.
    EglContext(const Candidate& candidate, const ContextOptions& options)
        : egl_(Egl::get())
        , display_(candidate.display) {
        try {
            createOn(candidate, options);
        } catch (...) {
            release();
            throw;
        }
    }
    ~EglContext() override { release(); }
    EglContext(const EglContext&) = delete;
    EglContext& operator=(const EglContext&) = delete;

protected:
    void bind() override {
        if (egl_.eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE)
            throw MachineError(
                fmt::format("eglMakeCurrent without a surface failed (error 0x{:x}): the driver lacks "
                            "EGL_KHR_surfaceless_context; install libgl1-mesa-dri",
                            egl_.eglGetError()));
    }
    void unbind() override { egl_.eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }

private:
    void createOn(const Candidate& candidate, const ContextOptions& options) {
        if (display_ == EGL_NO_DISPLAY)
            throw MachineError("EGL gives no " + candidate.name + " display: install libgl1-mesa-dri");
        if (egl_.eglInitialize(display_, nullptr, nullptr) == EGL_FALSE)
            throw MachineError(fmt::format(
                "EGL cannot be initialised on its {} display (error 0x{:x}): install libgl1-mesa-dri",
                candidate.name, egl_.eglGetError()));
        if (egl_.eglBindAPI(EGL_OPENGL_API) == EGL_FALSE)
            throw MachineError("EGL offers no desktop OpenGL, only OpenGL ES: install libgl1-mesa-dri");
        createContext();
        finishCreation(egl_.eglGetProcAddress, options.debug);
        logDebug("EGL: {} display", candidate.name);
    }

    void createContext() {
        // Pairs that a driver may refuse come first, and go one after the other: to be told of resets
        // (lost_context.h), and debug output of all that there is, which softpipe takes for a bad attribute.
        constexpr EGLint attributes[] = {EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                                         EGL_LOSE_CONTEXT_ON_RESET,
#ifdef KESTREL_DEBUG
                                         EGL_CONTEXT_OPENGL_DEBUG,
                                         EGL_TRUE,
#endif
                                         EGL_CONTEXT_MAJOR_VERSION,
                                         4,
                                         EGL_CONTEXT_MINOR_VERSION,
                                         6,
                                         EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                         EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                         EGL_NONE};
        for (const EGLint* chosen = attributes; context_ == EGL_NO_CONTEXT; chosen += 2) {
            context_ = egl_.eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, chosen);
            if (*chosen == EGL_CONTEXT_MAJOR_VERSION) break;
        }
        if (context_ == EGL_NO_CONTEXT)
            throw MachineError(
                fmt::format("the driver refuses an OpenGL 4.6 core context (EGL error 0x{:x}): it needs "
                            "Mesa 22 or newer, or a GPU driver with OpenGL 4.6",
                            egl_.eglGetError()));
    }

    // The display stays initialised: it is the process's, and other contexts may live on it.
    void release() {
        if (context_ == EGL_NO_CONTEXT) return;
        unbind();
        egl_.eglDestroyContext(display_, context_);
        context_ = EGL_NO_CONTEXT;
    }

    const Egl& egl_;
    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
};

} // namespace

std::unique_ptr<Context> createEglContext(const ContextOptions& options) {
    const std::vector<Candidate> found = candidates(Egl::get());
    if (found.empty())
        throw MachineError(
            "EGL offers neither EGL_MESA_platform_surfaceless nor EGL_EXT_platform_device: install "
            "libgl1-mesa-dri, or use --backend osmesa");
    std::vector<Problem> failures;
    for (const Candidate& candidate : found) {
        try {
            return std::make_unique<EglContext>(candidate, options);
        } catch (const MachineError& error) {
            failures.insert(failures.end(), error.problems().begin(), error.problems().end());
        }
    }
    // The devices are mostly the same driver again: the first failure says most.
    throw MachineError("no EGL display gives OpenGL 4.6: " + failures.front().message);
}

} // namespace kestrel::gl
