# Unity builds: the sources of a folder are compiled in groups of up to `size`, which parses the headers once a group and
# more than halves the time of building from nothing. Off (-DKESTREL_UNITY=OFF), editing one file compiles one file.
option(KESTREL_UNITY "Compile sources in groups: faster from nothing, slower after an edit" OFF)

# kestrel_unity(TARGET): groups by folder, so that a new file regroups its own folder alone.
function(kestrel_unity target)
    if(NOT KESTREL_UNITY)
        return()
    endif()
    set(size 12)
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
