# The packages of apps/packages.txt as CMake targets. Required ones stop the configuration with the name of the
# Debian package; optional ones are left out with one line, and `kestrel --version` lists what is in.
include(FindPackageHandleStandardArgs)
find_package(Threads REQUIRED)

function(kestrel_require_header target header package)
    find_path(${target}_INCLUDE ${header} PATH_SUFFIXES ${ARGN})
    if(NOT ${target}_INCLUDE)
        message(FATAL_ERROR "${header} is missing: install ${package}")
    endif()
    add_library(kestrel_${target} INTERFACE)
    target_include_directories(kestrel_${target} SYSTEM INTERFACE ${${target}_INCLUDE})
endfunction()

function(kestrel_require_library target library package)
    find_library(${target}_LIBRARY ${library})
    if(NOT ${target}_LIBRARY)
        message(FATAL_ERROR "lib${library} is missing: install ${package}")
    endif()
    target_link_libraries(kestrel_${target} INTERFACE ${${target}_LIBRARY})
endfunction()

find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(glm REQUIRED)
# Debian's Imath tells at length that its Python module is not installed.
set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
find_package(OpenEXR QUIET)
unset(CMAKE_MESSAGE_LOG_LEVEL)
if(NOT OpenEXR_FOUND)
    message(FATAL_ERROR "OpenEXR is missing: install libopenexr-dev")
endif()

kestrel_require_header(tinygltf tiny_gltf.h libtinygltf-dev)
kestrel_require_library(tinygltf tinygltf libtinygltf-dev)
kestrel_require_header(stb stb_image.h libstb-dev stb)
kestrel_require_library(stb stb libstb-dev)

# Debian's glslang is a set of static libraries that refer to each other.
kestrel_require_header(glslang glslang/Public/ShaderLang.h glslang-dev)
set(glslang_group -Wl,--start-group)
foreach(part glslang MachineIndependent GenericCodeGen OGLCompiler OSDependent glslang-default-resource-limits SPIRV
             SPIRV-Tools-opt SPIRV-Tools)
    find_library(glslang_${part} ${part})
    if(NOT glslang_${part})
        message(FATAL_ERROR "lib${part} is missing: install glslang-dev and spirv-tools")
    endif()
    list(APPEND glslang_group ${glslang_${part}})
endforeach()
target_link_libraries(kestrel_glslang INTERFACE ${glslang_group} -Wl,--end-group)

# EGL is loaded at run time (dlopen), so only its header is needed; the same holds for OSMesa.
kestrel_require_header(egl EGL/egl.h libegl-dev)

set(KESTREL_PARTS "egl")
macro(kestrel_optional variable part package)
    if(${variable})
        list(APPEND KESTREL_PARTS ${part})
    else()
        message(STATUS "Left out: ${part} (${package} is not installed)")
    endif()
endmacro()

find_path(OSMESA_INCLUDE GL/osmesa.h)
set(KESTREL_HAS_OSMESA ${OSMESA_INCLUDE})
kestrel_optional(KESTREL_HAS_OSMESA osmesa libosmesa6-dev)

find_package(glfw3 QUIET)
set(KESTREL_HAS_WINDOW ${glfw3_FOUND})
kestrel_optional(KESTREL_HAS_WINDOW window libglfw3-dev)

find_path(IMGUI_INCLUDE imgui.h PATH_SUFFIXES imgui)
find_library(IMGUI_LIBRARY imgui)
if(KESTREL_HAS_WINDOW AND IMGUI_INCLUDE AND IMGUI_LIBRARY)
    set(KESTREL_HAS_EDITOR ON)
endif()
kestrel_optional(KESTREL_HAS_EDITOR editor libimgui-dev)

find_package(embree 4 QUIET)
if(NOT embree_FOUND)
    find_package(embree 3 QUIET)
endif()
set(KESTREL_HAS_EMBREE ${embree_FOUND})
kestrel_optional(KESTREL_HAS_EMBREE "embree${embree_VERSION_MAJOR}" libembree-dev)

# What glTF files compress meshes and textures with. kestrel_codecs is linked by the library, and by the tests that
# compress what the library is to read. Draco's shared library also exports a tinygltf and an stb of its own, of other
# versions than the packaged ones: its static library, whose symbols stay inside, keeps them apart.
add_library(kestrel_codecs INTERFACE)
find_package(draco QUIET)
set(KESTREL_HAS_DRACO ${draco_FOUND})
kestrel_optional(KESTREL_HAS_DRACO draco libdraco-dev)
if(KESTREL_HAS_DRACO)
    target_link_libraries(kestrel_codecs INTERFACE draco::draco_static)
    target_link_options(kestrel_codecs INTERFACE -Wl,--exclude-libs,libdraco.a)
    target_compile_definitions(kestrel_codecs INTERFACE KESTREL_HAS_DRACO=1)
endif()
find_package(meshoptimizer QUIET)
set(KESTREL_HAS_MESHOPT ${meshoptimizer_FOUND})
kestrel_optional(KESTREL_HAS_MESHOPT meshopt libmeshoptimizer-dev)
if(KESTREL_HAS_MESHOPT)
    target_link_libraries(kestrel_codecs INTERFACE meshoptimizer::meshoptimizer)
    target_compile_definitions(kestrel_codecs INTERFACE KESTREL_HAS_MESHOPT=1)
endif()
find_path(WEBP_INCLUDE webp/decode.h)
find_library(WEBP_LIBRARY webp)
if(WEBP_INCLUDE AND WEBP_LIBRARY)
    set(KESTREL_HAS_WEBP ON)
    target_include_directories(kestrel_codecs SYSTEM INTERFACE ${WEBP_INCLUDE})
    target_link_libraries(kestrel_codecs INTERFACE ${WEBP_LIBRARY})
    target_compile_definitions(kestrel_codecs INTERFACE KESTREL_HAS_WEBP=1)
endif()
kestrel_optional(KESTREL_HAS_WEBP webp libwebp-dev)

# The GL loader is generated from the packaged registry; no loader is kept in the tree.
find_program(GLAD glad REQUIRED)
