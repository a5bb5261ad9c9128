# Installs the build, builds the plugin template against what was installed, as its user would, and asks the program
# for the pass. Run by ctest: cmake -DBUILD=… -DSOURCE=… -DGENERATOR=… -P out_of_tree.cmake
set(work ${BUILD}/out_of_tree)
file(REMOVE_RECURSE ${work})

function(run what)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT result EQUAL 0)
        message(FATAL_ERROR "${what} failed (${result}):\n${output}")
    endif()
    set(output "${output}" PARENT_SCOPE)
endfunction()

run("cmake --install" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/prefix)
file(COPY ${SOURCE}/apps/plugin_template DESTINATION ${work})
run("configuring the template" ${CMAKE_COMMAND} -S ${work}/plugin_template -B ${work}/build -G ${GENERATOR}
    -DCMAKE_PREFIX_PATH=${work}/prefix)
run("building the template" ${CMAKE_COMMAND} --build ${work}/build)
if(NOT EXISTS ${work}/build/plugins/plugin_template.so)
    message(FATAL_ERROR "the template has built no plugins/plugin_template.so")
endif()
if(NOT EXISTS ${work}/build/plugins/shaders/plugin_template/invert.comp)
    message(FATAL_ERROR "the template's shaders do not lie beside its plugin")
endif()

set(ENV{KESTREL_PLUGINS} ${work}/build/plugins)
run("kestrel passes Invert" ${work}/prefix/bin/kestrel passes Invert)
if(NOT output MATCHES "Invert: One minus the signal")
    message(FATAL_ERROR "the plugin's pass is not known to the program:\n${output}")
endif()
run("kestrel passes GBuffer" ${work}/prefix/bin/kestrel passes GBuffer) # the plugins that were installed are there too
file(REMOVE_RECURSE ${work})
