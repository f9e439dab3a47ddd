#include <array>
#include <cstddef>

#include "sim/lidar/body_cast.hpp"
#include "sim/lidar/range_noise.hpp"
#include "sim/lidar/scan.hpp"
#include "sim/lidar/wall_scan.hpp"

namespace slalom::sim::detail {
namespace {

ScanKernels kernels_for(simd::Target target) {
  return {simd::kernel<ScanWalls>(target), simd::kernel<CastBody>(target),
          simd::kernel<AddRangeNoise>(target), simd::name(target)};
}

struct Available {
  std::array<ScanKernels, 4> list;
  std::size_t count = 0;
  Available() {
    for (const simd::Target target :
         {simd::Target::avx512, simd::Target::avx2, simd::Target::sse4, simd::Target::generic})
      if (simd::supported(target)) list[count++] = kernels_for(target);
  }
};

}  // namespace

const ScanKernels& scan_kernels() {
  static const ScanKernels chosen = kernels_for(simd::active_target());
  return chosen;
}

std::span<const ScanKernels> all_scan_kernels() {
  static const Available found;
  return std::span(found.list).first(found.count);
}

}  // namespace slalom::sim::detail
