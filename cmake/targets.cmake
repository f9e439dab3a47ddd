include(${CMAKE_CURRENT_LIST_DIR}/harden.cmake)

# slalom_add_layer(<name> SOURCES ... [DEPENDS <layers>] [LINK <private libraries>])
# A layer: the library slalom_<name>, which is slalom::<name> in the build tree and in the install tree.
function(slalom_add_layer name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;DEPENDS;LINK")
  add_library(slalom_${name} ${arg_SOURCES})
  add_library(slalom::${name} ALIAS slalom_${name})
  set_target_properties(slalom_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
  target_compile_features(slalom_${name} PUBLIC cxx_std_20)
  target_include_directories(slalom_${name}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${PROJECT_SOURCE_DIR}/src)
  foreach(layer IN LISTS arg_DEPENDS)
    target_link_libraries(slalom_${name} PUBLIC slalom_${layer})
  endforeach()
  foreach(library IN LISTS arg_LINK)
    target_link_libraries(slalom_${name} PRIVATE ${library})
  endforeach()
  slalom_compile_options(slalom_${name})
  if(SLALOM_SANITIZE)
    slalom_compile_for_this_machine(slalom_${name})
  endif()
  slalom_compile_in_groups(slalom_${name})
  slalom_set_rpath(slalom_${name} "$ORIGIN")
  set_property(GLOBAL APPEND PROPERTY SLALOM_LAYERS slalom_${name})
endfunction()

# Finds the instruction set of this machine, for slalom_compile_for_this_machine.
if(SLALOM_BUILD_TESTS AND NOT CMAKE_CROSSCOMPILING AND NOT DEFINED SLALOM_TEST_TARGET
    AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  try_run(ran compiled ${PROJECT_BINARY_DIR}/CMakeFiles ${PROJECT_SOURCE_DIR}/tests/support/instruction_set.cpp
    CMAKE_FLAGS -DINCLUDE_DIRECTORIES=${PROJECT_SOURCE_DIR}/include -DCMAKE_CXX_STANDARD=20
    RUN_OUTPUT_VARIABLE printed)
  if(compiled AND ran EQUAL 0)
    string(STRIP "${printed}" printed)
    set(SLALOM_TEST_TARGET ${printed} CACHE INTERNAL "Instruction set of this machine")
  endif()
endif()
function(slalom_compile_for_this_machine target)
  if(SLALOM_TEST_TARGET)
    target_compile_definitions(${target} PRIVATE SLALOM_ONLY_TARGET=${SLALOM_TEST_TARGET})
  endif()
endfunction()

# Flags of the targets of this project; none is exported. Tests set SLALOM_UNHARDENED: they are not installed.
# Functions take wide packs by reference, so the warning about their calling convention (-Wpsabi) does not
# apply. Clang takes constants of other sources in its group for shadowed ones.
function(slalom_compile_options target)
  set(clang_groups $<AND:$<BOOL:${SLALOM_GROUP_SOURCES}>,$<CXX_COMPILER_ID:Clang>>)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wno-psabi $<$<NOT:${clang_groups}>:-Wshadow>)
  if(SLALOM_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(SLALOM_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${SLALOM_SANITIZE} -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${SLALOM_SANITIZE})
    # With sanitizers, g++ takes initialised members for uninitialised ones, for instance those of <regex>,
    # and warns of the memory fences of Boost.Asio, which the thread sanitizer does not see.
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      target_compile_options(${target} PRIVATE -Wno-maybe-uninitialized)
      if(SLALOM_SANITIZE STREQUAL "thread")
        target_compile_options(${target} PRIVATE -Wno-tsan)
      endif()
    endif()
  elseif(NOT SLALOM_UNHARDENED)
    slalom_harden(${target})
  endif()
endfunction()

# Options of code that holds kernels: it reads no input, and the check of the stack would take 1.5 % of a
# solve. Fuzzers do not follow it: to instrument code that is compiled for every instruction set takes half an
# hour.
function(slalom_kernel_options variable)
  set(options -fno-stack-protector)
  if(SLALOM_SANITIZE MATCHES fuzzer)
    list(APPEND options -fno-sanitize=all)
  elseif(SLALOM_SANITIZE MATCHES address)
    # Packs are passed by reference; checks of these local variables make a kernel ten times slower.
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      list(APPEND options --param=asan-stack=0)
    else()
      list(APPEND options "SHELL:-mllvm -asan-stack=0")
    endif()
  endif()
  set(${variable} "${options}" PARENT_SCOPE)
endfunction()
# Source files of the current folder that hold kernels.
function(slalom_set_kernel_sources)
  slalom_kernel_options(options)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "${options}")
endfunction()

# Where a program or library looks for slalom's own shared libraries, in the build tree and in the install
# tree alike: below its own place. Otherwise CMake writes another path at install, and ends that of the build
# tree with a colon, which makes the loader search the current directory.
function(slalom_set_rpath target path)
  set_target_properties(${target} PROPERTIES BUILD_WITH_INSTALL_RPATH ON INSTALL_RPATH_USE_LINK_PATH ON)
  if(BUILD_SHARED_LIBS)
    set_target_properties(${target} PROPERTIES INSTALL_RPATH ${path})
  endif()
endfunction()

# For code whose time is spent in what it calls, or that runs once in an evaluation: less optimisation, which
# takes a quarter to a third of the compile time away. Applies to optimised builds alone.
function(slalom_optimise_lightly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()
# The same for source files of the current folder.
function(slalom_optimise_sources_lightly)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS $<$<CONFIG:Release>:-O1>)
endfunction()

# Compiles the sources of a target in groups of eight: most of their compile time is spent in headers that
# they share. Sources with options of their own stay alone. The presets dev, clang and tidy compile each
# source alone, which shows what a source forgets to include.
function(slalom_compile_in_groups target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${SLALOM_GROUP_SOURCES} UNITY_BUILD_BATCH_SIZE 8)
endfunction()
