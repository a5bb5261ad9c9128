#include "gl/requirements.h"
#include "core/error.h"
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kestrel::gl {
namespace {

// The ARB and KHR extensions that each version took in, where Mesa lists them by name. Of versions before 4.6
// only those that Kestrel's shaders and objects depend on.
constexpr const char* promoted[] = {
    // 4.0 to 4.2
    "GL_ARB_gpu_shader5", "GL_ARB_gpu_shader_fp64", "GL_ARB_texture_gather", "GL_ARB_draw_indirect",
    "GL_ARB_sample_shading", "GL_ARB_tessellation_shader", "GL_ARB_texture_buffer_object_rgb32",
    "GL_ARB_transform_feedback3", "GL_ARB_get_program_binary", "GL_ARB_viewport_array",
    "GL_ARB_shader_image_load_store", "GL_ARB_shader_atomic_counters", "GL_ARB_texture_storage",
    "GL_ARB_conservative_depth", "GL_ARB_base_instance",
    // 4.3
    "GL_ARB_compute_shader", "GL_ARB_shader_storage_buffer_object", "GL_ARB_program_interface_query",
    "GL_ARB_framebuffer_no_attachments", "GL_ARB_texture_view", "GL_ARB_copy_image", "GL_KHR_debug",
    "GL_ARB_multi_draw_indirect", "GL_ARB_texture_buffer_range",
    // 4.4
    "GL_ARB_buffer_storage", "GL_ARB_clear_texture", "GL_ARB_multi_bind", "GL_ARB_enhanced_layouts",
    "GL_ARB_query_buffer_object", "GL_ARB_texture_stencil8",
    // 4.5
    "GL_ARB_clip_control", "GL_ARB_direct_state_access", "GL_ARB_get_texture_sub_image",
    "GL_ARB_derivative_control", "GL_ARB_cull_distance", "GL_ARB_shader_texture_image_samples",
    "GL_ARB_texture_barrier", "GL_KHR_robustness",
    // 4.6, all of it
    "GL_ARB_indirect_parameters", "GL_ARB_pipeline_statistics_query", "GL_ARB_polygon_offset_clamp",
    "GL_ARB_shader_atomic_counter_ops", "GL_ARB_shader_draw_parameters", "GL_ARB_shader_group_vote",
    "GL_ARB_gl_spirv", "GL_ARB_spirv_extensions", "GL_ARB_texture_filter_anisotropic",
    "GL_ARB_transform_feedback_overflow_query", "GL_KHR_no_error"};

} // namespace

void overrideVersion() {
    constexpr int keepTheUsers = 0;
    setenv("MESA_GL_VERSION_OVERRIDE", "4.6", keepTheUsers);
    setenv("MESA_GLSL_VERSION_OVERRIDE", "460", keepTheUsers);
}

std::vector<std::string> missingExtensions(const std::set<std::string>& listed) {
    std::vector<std::string> missing;
    for (const char* extension : promoted)
        if (!listed.contains(extension)) missing.emplace_back(extension);
    return missing;
}

void requireOpenGl46(const std::string& version, const std::string& renderer,
                     const std::set<std::string>& listed) {
    int major = 0;
    int minor = 0;
    const bool readable = std::sscanf(version.c_str(), "%d.%d", &major, &minor) == 2;
    if (!readable || major < 4 || (major == 4 && minor < 6))
        throw MachineError(
            fmt::format("the driver gives OpenGL '{}' on '{}'; Kestrel needs 4.6", version, renderer));
    if (version.find("Mesa") == std::string::npos) return;
    const std::vector<std::string> missing = missingExtensions(listed);
    if (!missing.empty())
        throw MachineError(
            fmt::format("'{}' lacks what OpenGL 4.6 needs: {}", renderer, fmt::join(missing, ", ")));
}

} // namespace kestrel::gl
