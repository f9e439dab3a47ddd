#pragma once

#include <cstdint>

/// The instruction sets of kernels, as tags and as function attributes, and the one in use.

#if defined(__x86_64__) || defined(__i386__)
#define SLALOM_X86 1
#else
#define SLALOM_X86 0
#endif

#if SLALOM_X86
/// Instruction sets of SSE4 code.
#define SLALOM_ISA_SSE4 __attribute__((target("sse4.2")))
/// Instruction sets of AVX2 code.
#define SLALOM_ISA_AVX2 __attribute__((target("avx2,fma,bmi,bmi2")))
/// Instruction sets of AVX-512 code.
#define SLALOM_ISA_AVX512 \
  __attribute__((target("avx512f,avx512vl,avx512dq,avx512bw,avx512cd,avx2,fma,bmi,bmi2")))
#endif

/// Attribute of a function into which all that it calls is inlined. Kernels get it from dispatch.hpp.
#define SLALOM_TARGET_GENERIC __attribute__((flatten))

/// Marks functions that a kernel calls. g++ applies `flatten` to calls at every depth, but rejects functions
/// that are `always_inline`. clang applies it to direct calls only, so every function of a kernel is marked;
/// those that call a user's function, or an operation of one instruction set, are `SLALOM_INLINE_CALLS`.
#if defined(__clang__)
#define SLALOM_INLINE __attribute__((always_inline)) inline
/// Like SLALOM_INLINE, and inlines all calls in the function.
#define SLALOM_INLINE_CALLS __attribute__((always_inline, flatten)) inline
/// Lets clang fuse a product and a sum that stand in different inline functions (g++ does by default).
#define SLALOM_FUSE _Pragma("clang fp contract(fast)")
#else
#define SLALOM_INLINE inline
/// Like SLALOM_INLINE, and inlines all calls in the function.
#define SLALOM_INLINE_CALLS inline
/// Allows fused multiply-add.
#define SLALOM_FUSE
#endif

/// Keeps the compiler from fusing a product, a variable, with a sum that follows. clang fuses only what
/// SLALOM_FUSE allows it to; an unoptimised build fuses nothing.
#if defined(__clang__) || !defined(__OPTIMIZE__)
#define SLALOM_ROUND(product)
#elif SLALOM_X86
#define SLALOM_ROUND(product) __asm__("" : "+v"(product))
#elif defined(__aarch64__)
#define SLALOM_ROUND(product) __asm__("" : "+w"(product))
#else
#define SLALOM_ROUND(product) __asm__("" : "+m"(product))
#endif

namespace slalom::simd {

/// The instruction sets a batch loop is compiled for.
enum class Target : std::uint8_t { generic, sse4, avx2, avx512 };

/// The name of an instruction set, as `SLALOM_TARGET` takes it: "generic" (on AArch64 "neon"), "sse4",
/// "avx2", "avx512".
const char* name(Target target) noexcept;

/// Whether this processor (and operating system) runs the instruction set.
bool supported(Target target) noexcept;

/// The instruction set that kernels use: the widest supported one, or the one named by the environment
/// variable `SLALOM_TARGET`, read once. Throws std::invalid_argument if the variable names no instruction
/// set, or one that this processor lacks.
Target active_target();

/// Tags of the instruction sets: the `lanes` of a pack, and whether products and sums are fused, that is,
/// rounded once. `Generic` uses the build's baseline: SSE2, NEON or the SIMD128 of WebAssembly.
struct Generic {
  static constexpr int lanes = 4;  ///< number of float32 values
#if SLALOM_X86 || defined(__wasm__)
  static constexpr bool fused = false;  ///< whether it has fused multiply-add
#else
  static constexpr bool fused = true;  ///< whether it has fused multiply-add
#endif
};
/// SSE 4.2.
struct Sse4 {
  static constexpr int lanes = 4;       ///< number of float32 values
  static constexpr bool fused = false;  ///< whether it has fused multiply-add
};
/// AVX2 with FMA.
struct Avx2 {
  static constexpr int lanes = 8;      ///< number of float32 values
  static constexpr bool fused = true;  ///< whether it has fused multiply-add
};
/// AVX-512 F, DQ, BW and VL.
struct Avx512 {
  static constexpr int lanes = 16;     ///< number of float32 values
  static constexpr bool fused = true;  ///< whether it has fused multiply-add
};

/// The instruction set `T` without fused multiply-adds: every product is rounded before it is added. A kernel
/// that takes its packs from it gives the same bits on every instruction set, as long as it does not use
/// `reciprocal_sqrt`, whose approximations differ.
template <class T>
struct Unfused : T {
  static constexpr bool fused = false;  ///< products are rounded
};

/// Batches are padded to a multiple of this many samples, the lanes of the widest pack of all sets.
inline constexpr int padding = 16;

}  // namespace slalom::simd
