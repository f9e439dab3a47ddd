#include "slalom/core/dispatch.hpp"

#include <cstdlib>
#include <iterator>
#include <string>

namespace slalom::simd {

const char* name(Target target) noexcept {
#if defined(__aarch64__)
  constexpr const char* baseline = "neon";
#else
  constexpr const char* baseline = "generic";
#endif
  constexpr const char* names[] = {baseline, "sse4", "avx2", "avx512"};
  static_assert(std::size(names) == static_cast<int>(Target::avx512) + 1);
  return names[static_cast<int>(target)];
}

bool supported(Target target) noexcept {
#if SLALOM_X86
  switch (target) {
    case Target::avx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
             __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
             __builtin_cpu_supports("avx512cd") && supported(Target::avx2);
    case Target::avx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
             __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    case Target::sse4:
      return __builtin_cpu_supports("sse4.2");
    case Target::generic:
      return true;
  }
#endif
  return target == Target::generic;
}

namespace {

Target choose() {
  constexpr Target widest_first[] = {Target::avx512, Target::avx2, Target::sse4, Target::generic};
  const char* forced = std::getenv("SLALOM_TARGET");
  for (const Target target : widest_first) {
    if (forced && *forced) {
      if (forced != std::string(name(target))) continue;
      if (!supported(target))
        throw std::invalid_argument(std::string("SLALOM_TARGET=") + forced +
                                    ": not supported by this processor");
      return target;
    }
    if (supported(target)) return target;
  }
  throw std::invalid_argument(std::string("SLALOM_TARGET=") + forced + ": not one of avx512, avx2, sse4, " +
                              name(Target::generic));
}

}  // namespace

Target active_target() {
  static const Target target = choose();
  return target;
}

}  // namespace slalom::simd
