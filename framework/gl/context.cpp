#include "gl/context.h"
#include "core/error.h"
#include "core/log.h"
#include "gl/context_backends.h"
#include "gl/debug_output.h"
#include "gl/loader.h"
#include "gl/requirements.h"
#include <fmt/format.h>
#include <utility>

namespace kestrel::gl {
namespace {

std::string glString(GLenum name) {
    const auto* text = reinterpret_cast<const char*>(glGetString(name));
    return text == nullptr ? "" : text;
}

std::set<std::string> listedExtensions() {
    std::set<std::string> listed;
    const int count = glInteger(GL_NUM_EXTENSIONS);
    for (int i = 0; i < count; ++i)
        listed.emplace(reinterpret_cast<const char*>(glGetStringi(GL_EXTENSIONS, static_cast<GLuint>(i))));
    return listed;
}

// CPU renderers of Mesa name themselves.
bool isSoftware(const std::string& renderer) {
    for (const char* name : {"llvmpipe", "softpipe", "swrast", "SWR"})
        if (renderer.find(name) != std::string::npos) return true;
    return false;
}

Capabilities readCapabilities() {
    Capabilities result;
    result.renderer = glString(GL_RENDERER);
    result.version = glString(GL_VERSION);
    result.extensions = listedExtensions();
    result.maxComputeImages = glInteger(GL_MAX_COMPUTE_IMAGE_UNIFORMS);
    result.maxStorageBlocks = glInteger(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS);
    result.maxTextureUnits = glInteger(GL_MAX_COMPUTE_TEXTURE_IMAGE_UNITS);
    result.maxUniformBlocks = glInteger(GL_MAX_COMPUTE_UNIFORM_BLOCKS);
    result.maxTextureSize = glInteger(GL_MAX_TEXTURE_SIZE);
    result.max3DTextureSize = glInteger(GL_MAX_3D_TEXTURE_SIZE);
    result.maxArrayLayers = glInteger(GL_MAX_ARRAY_TEXTURE_LAYERS);
    result.maxComputeSharedBytes = glInteger(GL_MAX_COMPUTE_SHARED_MEMORY_SIZE);
    result.maxComputeInvocations = glInteger(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS);
    result.maxTextureBufferTexels = glInteger(GL_MAX_TEXTURE_BUFFER_SIZE);
    GLint64 blockBytes = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &blockBytes);
    result.maxStorageBlockBytes = blockBytes;
    result.software = isSoftware(result.renderer);
    return result;
}

// What never changes afterwards.
void setFixedState() {
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE); // for reversed depth: all precision far away
    glClearDepth(0.0);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glDisable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    glDisable(GL_PRIMITIVE_RESTART);
    glDisable(GL_PRIMITIVE_RESTART_FIXED_INDEX);
    glDisable(GL_DITHER);
    glDisable(GL_MULTISAMPLE);
    glDisable(GL_FRAMEBUFFER_SRGB);
    glFrontFace(GL_CCW);
}

// Whose functions glad's table holds.
void (*(*loadedFrom)(const char*))() = nullptr;

thread_local Context* current = nullptr;

std::unique_ptr<Context> createBackend(const ContextOptions& options) {
    switch (options.backend) {
    case Backend::Egl:
        return createEglContext(options);
    case Backend::OsMesa:
        return createOsMesaContext(options);
    case Backend::Window:
        return createWindowContext(options);
    }
    throw MachineError("no such backend");
}

} // namespace

Backend backendFromName(const std::string& name) {
    if (name == "egl") return Backend::Egl;
    if (name == "osmesa") return Backend::OsMesa;
    if (name == "window") return Backend::Window;
    throw InputError(fmt::format("unknown backend '{}'{}; there are egl, osmesa and window", name,
                                 didYouMean(name, {"egl", "osmesa", "window"})));
}

std::unique_ptr<Context> Context::create(const ContextOptions& options) {
    overrideVersion();
    Context* const before = std::exchange(current, nullptr);
    if (before != nullptr) before->unbind();
    try {
        return createBackend(options);
    } catch (...) {
        if (before != nullptr) before->makeCurrent();
        throw;
    }
}

std::uint64_t Context::severeErrors() { return severeErrorCount(); }

Context::~Context() {
    if (current == this) current = nullptr;
    if (current == nullptr) return;
    // The backend has just destroyed another context, which may have touched that dispatch table.
    try {
        current->makeCurrent();
    } catch (const MachineError& error) {
        logError("{}", error.what());
    }
}

void Context::makeCurrent() {
    // A window system refuses a second context on a thread that has one; and EGL and OSMesa of Mesa share one
    // dispatch table a thread, so what is current already is bound anew all the same.
    if (current != nullptr) current->unbind();
    current = nullptr;
    bind();
    current = this;
    loadFunctions();
}

void Context::loadFunctions() const {
    if (loadedFrom == getProcAddress_) return;
    if (gladLoadGL(reinterpret_cast<GLADloadfunc>(getProcAddress_)) == 0)
        throw MachineError("the driver's OpenGL functions cannot be loaded, though it made a context");
    loadedFrom = getProcAddress_;
}

void Context::finishCreation(GetProcAddress getProcAddress, bool debug) {
    getProcAddress_ = getProcAddress;
    loadedFrom = nullptr; // what is there depends on the context's version too
    makeCurrent();
    requireOpenGl46(glString(GL_VERSION), glString(GL_RENDERER), listedExtensions());
    if (debug) enableDebugOutput();
    capabilities_ = readCapabilities();
    driver_ = glString(GL_VENDOR) + ", " + glString(GL_VERSION);
    setFixedState();
    logDebug("OpenGL {} on {}", capabilities_.version, capabilities_.renderer);
}

void finish() { glFinish(); }

} // namespace kestrel::gl
