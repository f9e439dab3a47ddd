#include "sim/lidar/scan_kernel.hpp"

namespace slalom::sim::detail {

const Kernels kernels_avx512 = kernels_of<Avx512, 4>("avx512");

}  // namespace slalom::sim::detail
