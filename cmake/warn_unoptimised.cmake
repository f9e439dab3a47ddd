# Warns a project that uses slalom and has no build type: without one, CMake compiles it without optimisation.
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES AND NOT CMAKE_CXX_FLAGS MATCHES "-O")
  message(WARNING "slalom: this project sets no build type, so its rollouts are about 40 times slower. Before find_package, write\n"
    "if(NOT CMAKE_BUILD_TYPE)\n  set(CMAKE_BUILD_TYPE Release)\nendif()")
endif()
