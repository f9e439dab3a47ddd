# slalom_gpu_problem(<target> HEADER <file> PROBLEM <type> ARCHITECTURES <87 90 ...> [INCLUDE <folders>])
# A library with the code of a problem for GPUs; a program that uses `slalom::gpu::Mppi<type>` links it. Needs
# a CUDA toolkit (NVRTC) where it is built.

function(slalom_gpu_problem target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "HEADER;PROBLEM" "ARCHITECTURES;INCLUDE")
  find_package(CUDAToolkit REQUIRED QUIET)
  set(folder ${CMAKE_CURRENT_FUNCTION_LIST_DIR})
  if(NOT TARGET slalom_gpu_compile)
    add_executable(slalom_gpu_compile ${folder}/compile.cpp)
    target_compile_features(slalom_gpu_compile PRIVATE cxx_std_20)
    target_link_libraries(slalom_gpu_compile PRIVATE CUDA::nvrtc)
  endif()
  get_filename_component(header ${arg_HEADER} ABSOLUTE)
  set(includes ${folder} ${arg_INCLUDE})
  foreach(toolkit IN LISTS CUDAToolkit_INCLUDE_DIRS)
    list(APPEND includes ${toolkit}/cccl ${toolkit})
  endforeach()
  list(APPEND includes $<TARGET_PROPERTY:slalom::gpu,INTERFACE_INCLUDE_DIRECTORIES>)
  set(out ${CMAKE_CURRENT_BINARY_DIR}/${target}.cpp)
  set(headers ${folder}/../../include/slalom)
  file(GLOB sources CONFIGURE_DEPENDS ${folder}/*.cu ${folder}/*.hpp ${headers}/gpu/kernels/*.hpp ${headers}/core/*.hpp ${headers}/core/*/*.hpp
    ${headers}/problems/*.hpp ${folder}/../../src/solvers/methods/gaussian_fit.hpp)
  string(REPLACE ";" " " architectures "${arg_ARCHITECTURES}")
  add_custom_command(OUTPUT ${out} DEPENDS slalom_gpu_compile ${header} ${sources} VERBATIM COMMAND_EXPAND_LISTS
    COMMENT "Code of ${arg_PROBLEM} for GPUs"
    COMMAND slalom_gpu_compile ${out} ${header} ${arg_PROBLEM} ${architectures} "-I$<JOIN:${includes},;-I>")
  add_library(${target} STATIC ${out})
  target_link_libraries(${target} PUBLIC slalom::gpu)
  target_include_directories(${target} PRIVATE ${arg_INCLUDE})
endfunction()
