#include "core/error.h"
#include "gl/context_backends.h"
#ifdef KESTREL_HAS_OSMESA
#ifndef APIENTRY // osmesa.h of Mesa 25 writes it without defining it; on Linux it is empty
#define APIENTRY
#endif
#include <GL/osmesa.h>
#include <dlfcn.h>
#include <fmt/format.h>
#include <vector>
#endif

namespace kestrel::gl {

#ifndef KESTREL_HAS_OSMESA

std::unique_ptr<Context> createOsMesaContext(const ContextOptions&) {
    throw MachineError(
        "this build has no OSMesa: install libosmesa6-dev and build again, or use --backend egl");
}

#else

namespace {

// libOSMesa, loaded when first needed.
struct OsMesa {
    decltype(&::OSMesaCreateContextAttribs) createContext = nullptr;
    decltype(&::OSMesaDestroyContext) destroyContext = nullptr;
    decltype(&::OSMesaMakeCurrent) makeCurrent = nullptr;
    decltype(&::OSMesaGetProcAddress) getProcAddress = nullptr;

    static const OsMesa& get() {
        static const OsMesa instance;
        return instance;
    }

private:
    OsMesa() {
        void* library = nullptr;
        for (const char* name : {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"}) {
            library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
            if (library != nullptr) break;
        }
        if (library == nullptr)
            throw MachineError(fmt::format("libOSMesa cannot be loaded ({}): install libosmesa6", dlerror()));
        load(library, createContext, "OSMesaCreateContextAttribs");
        load(library, destroyContext, "OSMesaDestroyContext");
        load(library, makeCurrent, "OSMesaMakeCurrent");
        load(library, getProcAddress, "OSMesaGetProcAddress");
    }

    template<class Function>
    static void load(void* library, Function& function, const char* name) {
        function = reinterpret_cast<Function>(dlsym(library, name));
        if (function == nullptr)
            throw MachineError(fmt::format("libOSMesa has no {}: install a newer libosmesa6", name));
    }
};

class OsMesaContext final : public Context {
public:
    explicit OsMesaContext(const ContextOptions& options)
        : mesa_(OsMesa::get()) {
        constexpr int attributes[] = {OSMESA_FORMAT,
                                      OSMESA_RGBA,
                                      OSMESA_PROFILE,
                                      OSMESA_CORE_PROFILE,
                                      OSMESA_CONTEXT_MAJOR_VERSION,
                                      4,
                                      OSMESA_CONTEXT_MINOR_VERSION,
                                      6,
                                      0};
        context_ = mesa_.createContext(attributes, nullptr);
        if (context_ == nullptr)
            throw MachineError("OSMesa refuses an OpenGL 4.6 core context: it needs Mesa 22 or newer with "
                               "MESA_GL_VERSION_OVERRIDE unset or at least 4.6");
        try {
            finishCreation(mesa_.getProcAddress, options.debug);
        } catch (...) {
            mesa_.destroyContext(context_);
            throw;
        }
    }
    ~OsMesaContext() override { mesa_.destroyContext(context_); }
    OsMesaContext(const OsMesaContext&) = delete;
    OsMesaContext& operator=(const OsMesaContext&) = delete;

protected:
    void bind() override {
        if (mesa_.makeCurrent(context_, frame_, 0x1401 /* GL_UNSIGNED_BYTE */, side, side) == 0)
            throw MachineError("OSMesa cannot make its context current: install a newer libosmesa6");
    }
    void unbind() override { mesa_.makeCurrent(nullptr, nullptr, 0, 0, 0); }

private:
    // A context must have a frame to draw into; all that Kestrel draws goes into textures.
    static constexpr int side = 16;
    const OsMesa& mesa_;
    OSMesaContext context_ = nullptr;
    unsigned char frame_[4 * side * side] = {};
};

} // namespace

std::unique_ptr<Context> createOsMesaContext(const ContextOptions& options) {
    return std::make_unique<OsMesaContext>(options);
}

#endif

} // namespace kestrel::gl
