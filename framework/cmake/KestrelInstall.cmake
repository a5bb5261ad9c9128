# What `cmake --install` puts where; the layout is that of the build tree, so that libkestrel finds its folders by its
# own place: lib/, lib/kestrel/ (plugins), share/kestrel/ (shaders, graphs), include/kestrel/.
include(CMakePackageConfigHelpers)
install(TARGETS kestrel EXPORT KestrelTargets LIBRARY DESTINATION lib)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/framework/ DESTINATION include/kestrel FILES_MATCHING PATTERN "*.h"
        PATTERN cmake EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/shaders/shared DESTINATION include/kestrel FILES_MATCHING PATTERN "*.h")
if(EXISTS ${PROJECT_BINARY_DIR}/glad/include)
    install(DIRECTORY ${PROJECT_BINARY_DIR}/glad/include/ DESTINATION include/kestrel/glad)
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/shaders ${PROJECT_SOURCE_DIR}/graphs DESTINATION share/kestrel)

set(config_folder lib/cmake/Kestrel)
install(EXPORT KestrelTargets NAMESPACE Kestrel:: DESTINATION ${config_folder})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/KestrelConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/generated/KestrelConfig.cmake INSTALL_DESTINATION ${config_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/generated/KestrelConfigVersion.cmake
                                 COMPATIBILITY ExactVersion)
install(FILES ${PROJECT_BINARY_DIR}/generated/KestrelConfig.cmake
              ${PROJECT_BINARY_DIR}/generated/KestrelConfigVersion.cmake
              ${CMAKE_CURRENT_LIST_DIR}/KestrelPlugin.cmake
        DESTINATION ${config_folder})
