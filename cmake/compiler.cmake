# Stops with a clear message where the compiler is too old.
set(oldest_GNU 12)
set(oldest_Clang 14)
if(CMAKE_CXX_COMPILER_VERSION VERSION_LESS "${oldest_${CMAKE_CXX_COMPILER_ID}}")
  message(FATAL_ERROR "${CMAKE_CXX_COMPILER} is version ${CMAKE_CXX_COMPILER_VERSION}; Slalom needs g++ 12 or clang 14 or "
    "later. Choose another compiler with the environment variable CXX, for instance CXX=g++-12, in an empty build folder.")
endif()
