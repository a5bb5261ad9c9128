# What makes building from nothing faster; the README's scripts set both. A build without either is what shows a file
# that does not include what it uses (the strict stage of tests/run.sh).
# Unity builds: the sources of a folder are compiled in groups of up to `size`, which parses the headers once a group and
# more than halves the time of building from nothing. Off (-DKESTREL_UNITY=OFF), editing one file compiles one file.
option(KESTREL_UNITY "Compile sources in groups: faster from nothing, slower after an edit" OFF)

# kestrel_unity(TARGET): groups by folder, so that a new file regroups its own folder alone.
function(kestrel_unity target)
    if(NOT KESTREL_UNITY)
        return()
    endif()
    set(size 64)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    get_target_property(sources ${target} SOURCES)
    list(FILTER sources INCLUDE REGEX "\\.cpp$")
    foreach(source ${sources})
        get_filename_component(folder ${source} DIRECTORY)
        string(MD5 key "${folder}")
        if(NOT DEFINED count_${key})
            set(count_${key} 0)
        endif()
        math(EXPR number "${count_${key}} / ${size}")
        math(EXPR count_${key} "${count_${key}} + 1")
        set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${key}_${number})
    endforeach()
endfunction()

# Precompiled headers: four fifths of what a small file costs is parsing the same standard headers, GLM and fmt.
option(KESTREL_PCH "Precompile the headers that nearly every file includes" OFF)

# kestrel_precompile(OWNER HEADER FLAG [LIBRARY...]): makes a precompiled header. GCC takes one only where every macro of its
# making is defined alike, so its owner has those alone that come with the libraries, and where code is as independent of its
# position: FLAG is -fPIC for libraries, -fPIE for programs.
function(kestrel_precompile owner header flag)
    if(NOT KESTREL_PCH)
        return()
    endif()
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/${owner}.cpp CONTENT "")
    add_library(${owner} OBJECT ${PROJECT_BINARY_DIR}/generated/${owner}.cpp)
    target_link_libraries(${owner} PRIVATE kestrel_options ${ARGN})
    set_target_properties(${owner} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(${owner} PRIVATE ${flag})
    target_compile_definitions(${owner} PRIVATE GLM_FORCE_DEPTH_ZERO_TO_ONE)
    target_precompile_headers(${owner} PRIVATE ${header})
endfunction()

# kestrel_precompiled(TARGET OWNER): takes the precompiled header of OWNER.
function(kestrel_precompiled target owner)
    if(KESTREL_PCH)
        target_precompile_headers(${target} REUSE_FROM ${owner})
    endif()
endfunction()
