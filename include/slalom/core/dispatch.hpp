#pragma once

#include "slalom/core/simd.hpp"

namespace slalom::simd {

/// The name of an instruction set, as `SLALOM_TARGET` takes it: "generic" (on AArch64 "neon"), "sse4",
/// "avx2", "avx512".
const char* name(Target target) noexcept;

/// Whether this processor (and operating system) runs the instruction set.
bool supported(Target target) noexcept;

/// The instruction set that batch loops use: the widest supported one, or the one named by the environment
/// variable `SLALOM_TARGET`, read once. Throws std::invalid_argument if that names none, or one this
/// processor lacks.
Target active_target();

}  // namespace slalom::simd
