# Eigen is a library of headers that only sources and private headers include, so what is installed does not
# need it.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
function(slalom_use_eigen target)
  target_include_directories(${target} SYSTEM PRIVATE $<TARGET_PROPERTY:Eigen3::Eigen,INTERFACE_INCLUDE_DIRECTORIES>)
endfunction()
