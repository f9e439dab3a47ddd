#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>

#include "slalom/core/coefficient.hpp"

/// Packs of float32 lanes, so that one piece of template code runs a whole pack of samples at once.
///
/// A pack is made of the compiler's own vector types: its operators are ordinary inline functions that carry
/// no instruction set. A batch loop is compiled once per instruction set as a function with `SLALOM_TARGET_*`
/// (a target attribute plus `flatten`), into which everything is inlined; the wide vectors then become whole
/// registers of that set. So a user's own problem runs at full width without any compiler flag, and one
/// binary serves every processor. Only where the compilers do not find the right instruction (clamped
/// conversions, square roots, look-ups) does a pack call a function that is itself tied to an instruction
/// set.
///
/// Packs have a copy constructor of their own on purpose: so they are passed by reference in memory wherever
/// a call is not inlined (unoptimised builds), and the calling convention does not depend on the instruction
/// set.

#if defined(__x86_64__) || defined(__i386__)
#define SLALOM_X86 1
#include <immintrin.h>
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
#else
/// Instruction sets of SSE4 code.
#define SLALOM_ISA_SSE4
/// Instruction sets of AVX2 code.
#define SLALOM_ISA_AVX2
/// Instruction sets of AVX-512 code.
#define SLALOM_ISA_AVX512
#endif

/// Marks a function as the entry of a batch loop for one instruction set: everything it calls is inlined into
/// it.
#define SLALOM_TARGET_GENERIC __attribute__((flatten))
/// Attributes of a function that uses SSE4.
#define SLALOM_TARGET_SSE4 SLALOM_ISA_SSE4 __attribute__((flatten))
/// Attributes of a function that uses AVX2.
#define SLALOM_TARGET_AVX2 SLALOM_ISA_AVX2 __attribute__((flatten))
/// Attributes of a function that uses AVX-512.
#define SLALOM_TARGET_AVX512 SLALOM_ISA_AVX512 __attribute__((flatten))

/// On the small functions that make up a batch loop. g++ follows `flatten` all the way down, but only over
/// functions that are not `always_inline` (for those it settles too early that they cannot take in code of a
/// wider instruction set); clang inlines only one call deep and needs to be told, and told again
/// (`SLALOM_INLINE_CALLS`) where a function of another's making, or one of an instruction set, is called.
#if defined(__clang__)
#define SLALOM_INLINE __attribute__((always_inline)) inline
/// Like SLALOM_INLINE, and inlines all calls in the function.
#define SLALOM_INLINE_CALLS __attribute__((always_inline, flatten)) inline
#else
#define SLALOM_INLINE inline
/// Like SLALOM_INLINE, and inlines all calls in the function.
#define SLALOM_INLINE_CALLS inline
#endif

#if defined(__clang__)
/// Lets clang fuse a product and a sum that stand in different inline functions (g++ does by default).
#define SLALOM_FUSE _Pragma("clang fp contract(fast)")
#else
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

/// Tags of the instruction sets: `lanes` float32 values a pack, and whether it multiplies and adds with one
/// rounding. `Generic` uses what the build's baseline has (SSE2 on x86-64, NEON on AArch64).
struct Generic {
  static constexpr int lanes = 4;                 ///< number of float32 values
  static constexpr bool fused = SLALOM_X86 == 0;  ///< whether it has fused multiply-add
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
/// that takes its packs from it gives the same bits on every instruction set, as long as it uses no
/// `reciprocal_sqrt` and no function of math.hpp that says so.
template <class T>
struct Unfused : T {
  static constexpr bool fused = false;
};

/// Batches are padded to a multiple of this many samples, the lanes of the widest pack, whatever the
/// instruction set.
inline constexpr int padding = 16;

namespace detail {

template <int N>
struct VectorTypes {
  typedef float Float __attribute__((vector_size(4 * N)));
  typedef std::int32_t Int __attribute__((vector_size(4 * N)));
  typedef std::uint32_t Unsigned __attribute__((vector_size(4 * N)));
};

/// Whether products are rounded before they are added.
template <class T>
inline constexpr bool rounds_products = false;
template <class T>
inline constexpr bool rounds_products<Unfused<T>> = true;

/// What comparisons of packs yield: all bits of a lane set where true.
template <class T>
struct MaskVector {
  using type = typename VectorTypes<T::lanes>::Int;
};
/// AVX-512 compares into registers of one bit per lane, and selects by them.
template <>
struct MaskVector<Avx512> {
  using type = std::uint16_t;
};
template <class T>
struct MaskVector<Unfused<T>> : MaskVector<T> {};

/// One value in all lanes. x - 0 is x for every x, and so folds to a broadcast. But g++ builds a vector wider
/// than the baseline's lane by lane, unless it is told the instruction.
template <class T>
struct Broadcast {
  static void of(float value, typename VectorTypes<T::lanes>::Float& r) {
    r = value - typename VectorTypes<T::lanes>::Float{};
  }
};
#if SLALOM_X86
template <>
struct Broadcast<Avx2> {
  SLALOM_ISA_AVX2 static void of(float value, VectorTypes<8>::Float& r) {
    r = reinterpret_cast<VectorTypes<8>::Float>(_mm256_set1_ps(value));
  }
};
template <>
struct Broadcast<Avx512> {
  SLALOM_ISA_AVX512 static void of(float value, VectorTypes<16>::Float& r) {
    r = reinterpret_cast<VectorTypes<16>::Float>(_mm512_set1_ps(value));
  }
};
#endif
template <class T>
struct Broadcast<Unfused<T>> : Broadcast<T> {};

}  // namespace detail

/// One truth value per lane.
template <class T>
struct Mask {
  using Vector = typename detail::MaskVector<T>::type;
  static constexpr bool bits = std::is_integral_v<Vector>;  ///< one bit per lane
  Vector v;                                                 ///< all bits of a lane set where true

  Mask() = default;
  /// From lanes with all bits 1 or all bits 0.
  SLALOM_INLINE Mask(const Vector& vector) : v(vector) {}
  /// Copies.
  SLALOM_INLINE Mask(const Mask& other) : v(other.v) {}
  /// Copies.
  SLALOM_INLINE Mask& operator=(const Mask& other) {
    v = other.v;
    return *this;
  }
  /// The same value in all lanes.
  SLALOM_INLINE explicit Mask(bool value) {
    if constexpr (bits) {
      v = static_cast<Vector>(-static_cast<int>(value));
    } else {
      v = Vector{} - static_cast<int>(value);
    }
  }

  /// Applies to each lane.
  SLALOM_INLINE friend Mask operator&(const Mask& a, const Mask& b) {
    return Mask(static_cast<Vector>(a.v & b.v));
  }
  /// Applies to each lane.
  SLALOM_INLINE friend Mask operator|(const Mask& a, const Mask& b) {
    return Mask(static_cast<Vector>(a.v | b.v));
  }
  /// Applies to each lane.
  SLALOM_INLINE friend Mask operator!(const Mask& a) { return Mask(static_cast<Vector>(~a.v)); }
  /// Of one lane.
  bool operator[](int lane) const {
    if constexpr (bits) {
      return ((v >> lane) & 1) != 0;
    } else {
      return v[lane] != 0;
    }
  }
};

/// Operations for which compilers need to be told the instruction: simd_operations.hpp.
template <class T>
struct Operations;

/// A pack of 32-bit integers.
template <class T>
struct IntPack {
  using Vector = typename detail::VectorTypes<T::lanes>::Int;  ///< vector type of the compiler
  Vector v;                                                    ///< the lanes

  IntPack() = default;
  /// The same value in all lanes.
  SLALOM_INLINE explicit IntPack(int value) { v = Vector{} + value; }
  /// From a vector.
  SLALOM_INLINE IntPack(const Vector& vector) : v(vector) {}
  /// Copies.
  SLALOM_INLINE IntPack(const IntPack& other) : v(other.v) {}
  /// Copies.
  SLALOM_INLINE IntPack& operator=(const IntPack& other) {
    v = other.v;
    return *this;
  }

  /// Applies to each lane.
  SLALOM_INLINE friend IntPack operator+(const IntPack& a, const IntPack& b) { return IntPack(a.v + b.v); }
  /// Applies to each lane.
  SLALOM_INLINE friend IntPack operator*(const IntPack& a, int b) { return IntPack(a.v * b); }
  SLALOM_INLINE_CALLS friend Mask<T> operator<(const IntPack& a, const IntPack& b) {
    Mask<T> r;
    Operations<T>::less(a.v, b.v, r.v);
    return r;
  }
  SLALOM_INLINE_CALLS friend Mask<T> operator>(const IntPack& a, const IntPack& b) { return b < a; }
  SLALOM_INLINE_CALLS friend Mask<T> operator==(const IntPack& a, const IntPack& b) {
    Mask<T> r;
    Operations<T>::equal(a.v, b.v, r.v);
    return r;
  }
};

/// A pack of float32 values: arithmetic like a float's, lane by lane.
template <class T>
struct Pack {
  using Target = T;                                              ///< the instruction set
  using Vector = typename detail::VectorTypes<T::lanes>::Float;  ///< vector type of the compiler
  static constexpr int lanes = T::lanes;                         ///< number of float32 values
  Vector v;                                                      ///< the lanes

  Pack() = default;
  /// The same value in all lanes.
  SLALOM_INLINE_CALLS Pack(float value) { detail::Broadcast<T>::of(value, v); }
  /// The same value in all lanes, rounded to float32.
  SLALOM_INLINE Pack(double value) : Pack(static_cast<float>(value)) {}
  /// The same value in all lanes.
  SLALOM_INLINE Pack(int value) : Pack(static_cast<float>(value)) {}
  /// The same value in all lanes, already rounded.
  SLALOM_INLINE Pack(const Coefficient& value) : Pack(value.rounded()) {}
  /// From a vector.
  SLALOM_INLINE Pack(const Vector& vector) : v(vector) {}
  /// Copies.
  SLALOM_INLINE Pack(const Pack& other) : v(other.v) {}
  /// Copies.
  SLALOM_INLINE Pack& operator=(const Pack& other) {
    v = other.v;
    return *this;
  }

  /// Reads one value for each lane.
  SLALOM_INLINE static Pack load(const float* from) {
    Pack p;
    std::memcpy(&p.v, from, sizeof p.v);
    return p;
  }
  /// Writes the lanes.
  SLALOM_INLINE void store(float* to) const { std::memcpy(to, &v, sizeof v); }
  float operator[](int lane) const { return v[lane]; }  ///< of a lane

  /// Applies to each lane.
  SLALOM_INLINE friend Pack operator+(const Pack& a, const Pack& b) { SLALOM_FUSE return Pack(a.v + b.v); }
  /// Applies to each lane.
  SLALOM_INLINE friend Pack operator-(const Pack& a, const Pack& b) { SLALOM_FUSE return Pack(a.v - b.v); }
  /// Applies to each lane.
  SLALOM_INLINE friend Pack operator*(const Pack& a, const Pack& b) {
    if constexpr (detail::rounds_products<T>) {
      Vector product = a.v * b.v;
      SLALOM_ROUND(product);
      return Pack(product);
    } else {
      SLALOM_FUSE return Pack(a.v * b.v);
    }
  }
  /// Applies to each lane.
  SLALOM_INLINE friend Pack operator/(const Pack& a, const Pack& b) { return Pack(a.v / b.v); }
  /// Applies to each lane.
  SLALOM_INLINE friend Pack operator-(const Pack& a) { return Pack(-a.v); }
  /// Applies to each lane.
  SLALOM_INLINE Pack& operator+=(const Pack& b) { return *this = *this + b; }
  /// Applies to each lane.
  SLALOM_INLINE Pack& operator-=(const Pack& b) { return *this = *this - b; }
  /// Applies to each lane.
  SLALOM_INLINE Pack& operator*=(const Pack& b) { return *this = *this * b; }
  /// Applies to each lane.
  SLALOM_INLINE Pack& operator/=(const Pack& b) { return *this = *this / b; }

  /// Applies to each lane.
  SLALOM_INLINE_CALLS friend Mask<T> operator<(const Pack& a, const Pack& b) {
    Mask<T> r;
    Operations<T>::less(a.v, b.v, r.v);
    return r;
  }
  /// Applies to each lane.
  SLALOM_INLINE_CALLS friend Mask<T> operator<=(const Pack& a, const Pack& b) {
    Mask<T> r;
    Operations<T>::less_or_equal(a.v, b.v, r.v);
    return r;
  }
  /// Applies to each lane.
  SLALOM_INLINE_CALLS friend Mask<T> operator>(const Pack& a, const Pack& b) { return b < a; }
  /// Applies to each lane.
  SLALOM_INLINE_CALLS friend Mask<T> operator>=(const Pack& a, const Pack& b) { return b <= a; }
};

}  // namespace slalom::simd
