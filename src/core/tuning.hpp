#pragma once

#include "slalom/core/tuning.hpp"

namespace slalom::simd::detail {

/// Makes the choices for kernels of this instruction set, as the public header `tuning.hpp` says.
void choose(Target target);

}  // namespace slalom::simd::detail
