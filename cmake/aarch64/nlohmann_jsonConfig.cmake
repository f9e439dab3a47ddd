# The header-only package of the build machine. Its folder is searched last, since it also has the C library
# of that machine.
if(NOT TARGET nlohmann_json::nlohmann_json)
  add_library(nlohmann_json::nlohmann_json INTERFACE IMPORTED)
  target_compile_options(nlohmann_json::nlohmann_json INTERFACE -idirafter /usr/include)
endif()
