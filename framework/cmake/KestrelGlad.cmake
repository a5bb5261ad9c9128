# Generates the OpenGL 4.6 core loader with glad from its packaged registry, at configuration time.
set(glad_dir ${PROJECT_BINARY_DIR}/glad)
set(glad_extensions
    GL_ARB_fragment_shader_interlock GL_ARB_shader_viewport_layer_array GL_EXT_shader_framebuffer_fetch
    GL_ARB_texture_filter_anisotropic GL_EXT_texture_filter_anisotropic GL_KHR_parallel_shader_compile
    GL_ARB_shader_ballot GL_ARB_sample_locations)
list(JOIN glad_extensions "," glad_extension_list)
if(NOT EXISTS ${glad_dir}/src/gl.c)
    execute_process(
        COMMAND ${GLAD} --api gl:core=4.6 --out-path ${glad_dir} --reproducible --extensions ${glad_extension_list} c
        RESULT_VARIABLE glad_result OUTPUT_QUIET ERROR_VARIABLE glad_errors)
    if(NOT glad_result EQUAL 0)
        message(FATAL_ERROR "glad failed to generate the GL loader:\n${glad_errors}")
    endif()
endif()
# A target of its own: the only C, which the precompiled header of C++ does not serve.
add_library(kestrel_glad OBJECT ${glad_dir}/src/gl.c)
target_compile_options(kestrel_glad PRIVATE -O2 -w)
target_include_directories(kestrel_glad PRIVATE ${glad_dir}/include)
target_sources(kestrel PRIVATE $<TARGET_OBJECTS:kestrel_glad>)
target_include_directories(kestrel SYSTEM PUBLIC $<BUILD_INTERFACE:${glad_dir}/include> $<INSTALL_INTERFACE:include/kestrel/glad>)
