#pragma once

#include "slalom/core/instruction_set.hpp"

namespace slalom::simd::detail {

/// Makes the choice of `active_cell_access()` for kernels of this instruction set.
void choose_cell_access(Target target);

}  // namespace slalom::simd::detail
