# Sets yaml_target: the older yaml-cpp packages of Debian and Ubuntu name their target without a namespace.
find_package(yaml-cpp REQUIRED)
set(yaml_target yaml-cpp)
if(TARGET yaml-cpp::yaml-cpp)
  set(yaml_target yaml-cpp::yaml-cpp)
endif()
