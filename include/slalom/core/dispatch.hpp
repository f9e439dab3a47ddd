#pragma once

#include <stdexcept>

#include "slalom/core/simd_operations.hpp"

/// Runs batch loops at the full vector width of the processor.
///
/// A kernel is a struct with one static function template over the instruction set (`simd::Generic`, `Sse4`,
/// `Avx2`, `Avx512`), marked `SLALOM_KERNEL`:
///
///     struct Scale {
///       template <class Target>
///       SLALOM_KERNEL static void run(float factor, int count, float* values) {
///         using F = Pack<Target>;
///         for (int k = 0; k < count; k += F::lanes) (F::load(values + k) * F(factor)).store(values + k);
///       }
///     };
///
///     simd::dispatch<Scale>(2.0f, count, values);     // on the widest instruction set of the processor
///     simd::kernel<Scale>(simd::Target::sse4)(...);   // on a given one: tests and benchmarks
///
/// `run` is instantiated for each instruction set and inlined, with all that it calls, into a function that
/// carries the target attributes of that set. Rules for a kernel:
///  - The signature does not depend on `Target`, and `run` is not overloaded.
///  - Functions that `run` calls are templates over `Target` or over a pack, marked `SLALOM_INLINE`, or
///    `SLALOM_INLINE_CALLS` if they call a function of a user's problem or an operation of
///    `simd::Operations`. clang inlines only functions with this mark; g++ inlines everything.
///  - Packs are passed by reference and returned by value; no pack is part of the signature of `run`.
///  - A kernel whose results must have the same bits on every instruction set uses packs of
///    `simd::Unfused<Target>`.
namespace slalom::simd {

/// Marks the function template `run` of a kernel.
#define SLALOM_KERNEL SLALOM_INLINE_CALLS

namespace detail {

/// The functions of a kernel with the attributes of each instruction set.
template <class Kernel, class Result, class... Arguments>
struct KernelFunctions {
  using Pointer = Result (*)(Arguments...);

  SLALOM_TARGET_GENERIC static Result generic(Arguments... arguments) {
    return Kernel::template run<Generic>(static_cast<Arguments&&>(arguments)...);
  }
#if SLALOM_X86
  SLALOM_ISA_SSE4 SLALOM_TARGET_GENERIC static Result sse4(Arguments... arguments) {
    return Kernel::template run<Sse4>(static_cast<Arguments&&>(arguments)...);
  }
  SLALOM_ISA_AVX2 SLALOM_TARGET_GENERIC static Result avx2(Arguments... arguments) {
    return Kernel::template run<Avx2>(static_cast<Arguments&&>(arguments)...);
  }
  SLALOM_ISA_AVX512 SLALOM_TARGET_GENERIC static Result avx512(Arguments... arguments) {
    return Kernel::template run<Avx512>(static_cast<Arguments&&>(arguments)...);
  }
#endif
};

template <class Kernel, class Result, class... Arguments>
KernelFunctions<Kernel, Result, Arguments...> functions_of(Result (*)(Arguments...));

template <class Kernel>
using FunctionsOf = decltype(functions_of<Kernel>(&Kernel::template run<Generic>));

}  // namespace detail

/// A pointer to a kernel's `run`.
template <class Kernel>
using KernelPointer = typename detail::FunctionsOf<Kernel>::Pointer;

/// Returns a kernel's function for an instruction set, which the processor must support. Tests define
/// SLALOM_ONLY_TARGET (avx512, avx2, sse4 or generic) to compile faster: they have kernels only for that
/// instruction set, and asking for another one throws std::logic_error.
template <class Kernel>
KernelPointer<Kernel> kernel(Target target) {
  using Functions = detail::FunctionsOf<Kernel>;
#if defined(SLALOM_ONLY_TARGET)
  if (target != Target::SLALOM_ONLY_TARGET)
    throw std::logic_error("this program has kernels for one instruction set alone");
  return Functions::SLALOM_ONLY_TARGET;
#elif SLALOM_X86
  constexpr KernelPointer<Kernel> all[] = {Functions::generic, Functions::sse4, Functions::avx2,
                                           Functions::avx512};
  return all[static_cast<int>(target)];
#else
  static_cast<void>(target);
  return Functions::generic;
#endif
}

/// A kernel's function for `active_target()`, chosen at the first call. Throws as `active_target()` does.
template <class Kernel>
KernelPointer<Kernel> kernel() {
  static const KernelPointer<Kernel> chosen = kernel<Kernel>(active_target());
  return chosen;
}

/// Calls a kernel's function for `active_target()`.
template <class Kernel, class... Arguments>
decltype(auto) dispatch(Arguments&&... arguments) {
  return kernel<Kernel>()(static_cast<Arguments&&>(arguments)...);
}

}  // namespace slalom::simd
