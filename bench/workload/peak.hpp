#pragma once

#include "slalom/core/simd.hpp"

namespace slalom::workload {

/// The peak float32 performance of one core, GFLOP/s, where a fused multiply-add counts as two operations.
/// Measured on independent operations in registers.
double measured_peak_gflops(simd::Target target);

}  // namespace slalom::workload
