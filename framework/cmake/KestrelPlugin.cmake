# kestrel_plugin(NAME source...): one plugin. The same function builds the passes of the tree and, after
# find_package(Kestrel), plugins of other projects. The library is called NAME.so; it lies in
# ${KESTREL_PLUGIN_FOLDER} (default: kestrel/ in the build folder), where $KESTREL_PLUGINS can point.
function(kestrel_plugin name)
    set(target plugin_${name})
    add_library(${target} MODULE ${ARGN})
    if(TARGET kestrel_options)
        target_link_libraries(${target} PRIVATE kestrel_options)
    elseif(KESTREL_CONFIG STREQUAL "sanitize")
        target_compile_options(${target} PRIVATE -fsanitize=address,undefined)
        target_link_options(${target} PRIVATE -fsanitize=address,undefined)
    endif()
    target_link_libraries(${target} PRIVATE Kestrel::kestrel)
    target_compile_features(${target} PRIVATE cxx_std_20)
    if(KESTREL_PLUGIN_FOLDER)
        set(folder ${KESTREL_PLUGIN_FOLDER})
    else()
        set(folder ${CMAKE_CURRENT_BINARY_DIR}/kestrel)
    endif()
    set_target_properties(${target} PROPERTIES PREFIX "" OUTPUT_NAME ${name} LIBRARY_OUTPUT_DIRECTORY ${folder}
                          CXX_EXTENSIONS OFF INSTALL_RPATH "$ORIGIN/..")
    install(TARGETS ${target} LIBRARY DESTINATION lib/kestrel)
endfunction()
