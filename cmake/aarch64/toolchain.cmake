# Cross-compiles for AArch64 with the compiler of Debian; tests run under the user-mode emulation of qemu. The
# packages that the tests need are beside this file.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
# The libraries of the compiler, and those that script/checks/aarch64 unpacks.
set(aarch64_packages ${CMAKE_CURRENT_LIST_DIR}/../../build/aarch64-packages)
set(CMAKE_FIND_ROOT_PATH /usr/aarch64-linux-gnu ${aarch64_packages})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_CROSSCOMPILING_EMULATOR
  "qemu-aarch64;-L;/usr/aarch64-linux-gnu;-E;LD_LIBRARY_PATH=${aarch64_packages}/usr/lib/aarch64-linux-gnu:${aarch64_packages}/lib/aarch64-linux-gnu")
set(GTest_DIR ${CMAKE_CURRENT_LIST_DIR})
set(nlohmann_json_DIR ${CMAKE_CURRENT_LIST_DIR})
set(Eigen3_DIR /usr/share/eigen3/cmake)
