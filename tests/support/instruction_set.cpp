// Prints the instruction set of this machine, for which cmake/targets.cmake compiles most tests.
#include "../../src/core/dispatch.cpp"

#include <cstdio>

int main() {
  std::puts(slalom::simd::name(slalom::simd::active_target()));
}
