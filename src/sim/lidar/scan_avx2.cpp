#include "sim/lidar/scan_kernel.hpp"

namespace slalom::sim::detail {

const Kernels kernels_avx2 = kernels_of<Avx2, 4>("avx2");

}  // namespace slalom::sim::detail
