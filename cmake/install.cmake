# slalom::slalom, the install tree and the package files.
add_library(slalom INTERFACE)
add_library(slalom::slalom ALIAS slalom)
get_property(layers GLOBAL PROPERTY SLALOM_LAYERS)
target_link_libraries(slalom INTERFACE ${layers})

if(SLALOM_INSTALL)
  include(CMakePackageConfigHelpers)
  install(TARGETS slalom ${layers} EXPORT slalom-targets)
  install(DIRECTORY include/slalom DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.hpp")
  install(EXPORT slalom-targets NAMESPACE slalom:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/slalom)
  configure_package_config_file(cmake/slalom-config.cmake.in slalom-config.cmake
    INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/slalom)
  write_basic_package_version_file(slalom-config-version.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/slalom-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/slalom-config-version.cmake
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/slalom)
  install(DIRECTORY configs courses DESTINATION ${CMAKE_INSTALL_DATADIR}/slalom OPTIONAL)
endif()
