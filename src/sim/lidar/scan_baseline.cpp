#include "sim/lidar/scan_kernel.hpp"

namespace slalom::sim::detail {

const Kernels kernels_baseline = kernels_of<Baseline, 4>("baseline");

}  // namespace slalom::sim::detail
