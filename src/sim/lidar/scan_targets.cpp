#include <array>
#include <cstddef>

#include "sim/lidar/scan.hpp"
#include "slalom/core/dispatch.hpp"

namespace slalom::sim::detail {
namespace {

struct Available {
  std::array<Kernels, 3> list;
  std::size_t count = 0;
  Available() {
#if defined(__x86_64__)
    if (simd::supported(simd::Target::avx512)) list[count++] = kernels_avx512;
    if (simd::supported(simd::Target::avx2)) list[count++] = kernels_avx2;
#endif
    list[count++] = kernels_baseline;
  }
};

}  // namespace

const Kernels& kernels() {
#if defined(__x86_64__)
  const simd::Target target = simd::active_target();
  if (target == simd::Target::avx512) return kernels_avx512;
  if (target == simd::Target::avx2) return kernels_avx2;
#endif
  return kernels_baseline;
}

std::span<const Kernels> all_kernels() {
  static const Available found;
  return std::span(found.list).first(found.count);
}

}  // namespace slalom::sim::detail
