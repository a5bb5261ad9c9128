# Generates kestrel_stamp.h: the part of the plugin stamp that speaks of Kestrel's own headers. Two uses of one file:
# included, it adds the rule to target kestrel; run as a script (cmake -P), it writes the header.
if(CMAKE_SCRIPT_MODE_FILE)
    file(GLOB_RECURSE headers RELATIVE ${ROOT} ${ROOT}/framework/*.h ${ROOT}/shaders/shared/*.h)
    list(SORT headers)
    set(hashes "")
    foreach(header ${headers})
        file(SHA1 ${ROOT}/${header} hash)
        string(APPEND hashes "${header} ${hash}\n")
    endforeach()
    string(SHA1 hash "${hashes}")
    string(SUBSTRING ${hash} 0 16 hash)
    set(text "// Generated: what a plugin was built against.\n#pragma once\n#define KESTREL_STAMP_VERSION \"${VERSION}\"\n")
    string(APPEND text "#define KESTREL_STAMP_HEADERS \"${hash}\"\n")
    set(old "")
    if(EXISTS ${OUTPUT})
        file(READ ${OUTPUT} old)
    endif()
    if(NOT old STREQUAL text)
        file(WRITE ${OUTPUT} "${text}")
    endif()
    return()
endif()

file(GLOB_RECURSE stamp_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/framework/*.h
     ${PROJECT_SOURCE_DIR}/shaders/shared/*.h)
set(stamp_folder ${PROJECT_BINARY_DIR}/generated)
add_custom_command(
    OUTPUT ${stamp_folder}/stamp_is_written
    BYPRODUCTS ${stamp_folder}/kestrel_stamp.h # rewritten only if it changes, so that nothing is built for nothing
    COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} -DVERSION=${PROJECT_VERSION}
            -DOUTPUT=${stamp_folder}/kestrel_stamp.h -P ${CMAKE_CURRENT_LIST_FILE}
    COMMAND ${CMAKE_COMMAND} -E touch ${stamp_folder}/stamp_is_written
    DEPENDS ${stamp_headers} ${CMAKE_CURRENT_LIST_FILE}
    COMMENT "Stamp of the headers")
add_custom_target(kestrel_stamp DEPENDS ${stamp_folder}/stamp_is_written)
add_dependencies(kestrel kestrel_stamp)
target_include_directories(kestrel PUBLIC $<BUILD_INTERFACE:${stamp_folder}>)
install(FILES ${stamp_folder}/kestrel_stamp.h DESTINATION include/kestrel)
