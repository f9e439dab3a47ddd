#pragma once

#include "slalom/core/simd.hpp"

namespace slalom::tools {

/// The most float32 operations a second one core does here, GFLOP/s, a fused multiply and add counted as two:
/// measured on independent ones in registers.
double measured_peak_gflops(simd::Target target);

}  // namespace slalom::tools
