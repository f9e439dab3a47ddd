#pragma once

#include "slalom/core/math.hpp"
#include "slalom/core/simd_operations.hpp"

/// Packs of float64 values, with half as many lanes as a `Pack`, for the few loops that need the precision.
/// They have only the operations that these loops use.
namespace slalom::simd {

namespace detail {

template <int N>
struct DoubleVectorTypes {
  typedef double Double __attribute__((vector_size(4 * N)));
  typedef std::int64_t Long __attribute__((vector_size(4 * N)));
  typedef std::int32_t Int __attribute__((vector_size(2 * N)));  ///< indices, one per lane
};

template <class T>
struct DoubleMaskVector {
  using type = typename DoubleVectorTypes<T::lanes>::Long;
};
template <>
struct DoubleMaskVector<Avx512> {
  using type = std::uint8_t;
};
template <class T>
struct DoubleMaskVector<Unfused<T>> : DoubleMaskVector<T> {};

}  // namespace detail

/// Portable implementations of the operations for which compilers need to be told the instruction, as in
/// simd_operations.hpp.
template <class T>
struct PortableDoubleOperations {
  using D = typename detail::DoubleVectorTypes<T::lanes>::Double;  ///< vector of float64 values
  using L = typename detail::DoubleVectorTypes<T::lanes>::Long;    ///< mask, one 64-bit integer for each lane
  using I = typename detail::DoubleVectorTypes<T::lanes>::Int;     ///< vector of indices

  /// Sets all lanes to `value`.
  static void broadcast(double value, D& r) { r = value - D{}; }
  /// Whether a < b, in each lane.
  static void less(const D& a, const D& b, L& r) { r = a < b; }
  /// Whether a <= b, in each lane.
  static void less_or_equal(const D& a, const D& b, L& r) { r = a <= b; }
  /// `a` in lanes where the condition is true, else `b`.
  static void select(const L& condition, const D& a, const D& b, D& r) { r = condition ? a : b; }
  /// Whether any lane is set.
  static bool any(const L& mask) {
    std::int64_t all = 0;
    for (int i = 0; i < T::lanes / 2; ++i) all |= mask[i];
    return all != 0;
  }
  /// Reads from[index] in each lane.
  static void gather(const double* from, const I& index, D& r) {
    for (int i = 0; i < T::lanes / 2; ++i) r[i] = from[index[i]];
  }
};

/// The operations of each instruction set.
template <class T>
struct DoubleOperations : PortableDoubleOperations<T> {};

#if SLALOM_X86
template <>
struct DoubleOperations<Avx2> : PortableDoubleOperations<Avx2> {
  SLALOM_ISA_AVX2 static void broadcast(double value, D& r) { r = (D)_mm256_set1_pd(value); }
  SLALOM_ISA_AVX2 static bool any(const L& mask) { return _mm256_movemask_pd((__m256d)mask) != 0; }
  SLALOM_ISA_AVX2 static void gather(const double* from, const I& index, D& r) {
    // With a mask, since the form without one trips a false warning of g++ 12.
    const __m256d all = (__m256d)_mm256_set1_epi64x(-1);
    r = (D)_mm256_mask_i32gather_pd(_mm256_setzero_pd(), from, (__m128i)index, all, 8);
  }
};

template <>
struct DoubleOperations<Avx512> : PortableDoubleOperations<Avx512> {
  SLALOM_ISA_AVX512 static void broadcast(double value, D& r) { r = (D)_mm512_set1_pd(value); }
  SLALOM_ISA_AVX512 static void less(const D& a, const D& b, std::uint8_t& r) {
    r = _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
  }
  SLALOM_ISA_AVX512 static void less_or_equal(const D& a, const D& b, std::uint8_t& r) {
    r = _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LE_OQ);
  }
  SLALOM_ISA_AVX512 static void select(const std::uint8_t& condition, const D& a, const D& b, D& r) {
    r = (D)_mm512_mask_blend_pd(condition, (__m512d)b, (__m512d)a);
  }
  /// Whether any lane is set.
  static bool any(const std::uint8_t& mask) { return mask != 0; }
  SLALOM_ISA_AVX512 static void gather(const double* from, const I& index, D& r) {
    r = (D)_mm512_mask_i32gather_pd(_mm512_setzero_pd(), 0xff, (__m256i)index, from, 8);
  }
};
#endif

template <class T>
struct DoubleOperations<Unfused<T>> : DoubleOperations<T> {};

/// One truth value per lane of a `DoublePack`.
template <class T>
struct DoubleMask {
  using Vector = typename detail::DoubleMaskVector<T>::type;  ///< vector type of the compiler
  Vector v;                                                   ///< the lanes

  DoubleMask() = default;
  /// From a vector.
  SLALOM_INLINE DoubleMask(const Vector& vector) : v(vector) {}
  SLALOM_INLINE DoubleMask(const DoubleMask& other) : v(other.v) {}
  SLALOM_INLINE DoubleMask& operator=(const DoubleMask& other) {
    v = other.v;
    return *this;
  }
  SLALOM_INLINE friend DoubleMask operator&(const DoubleMask& a, const DoubleMask& b) {
    return DoubleMask(static_cast<Vector>(a.v & b.v));
  }
};

/// A pack of float64 values: arithmetic like a double's, lane by lane. Products are rounded before they are
/// added, on every instruction set.
template <class T>
struct DoublePack {
  using Target = T;                                                     ///< the instruction set
  using Vector = typename detail::DoubleVectorTypes<T::lanes>::Double;  ///< vector type of the compiler
  using Int = typename detail::DoubleVectorTypes<T::lanes>::Int;        ///< vector of indices
  static constexpr int lanes = T::lanes / 2;                            ///< number of float64 values
  Vector v;                                                             ///< the lanes

  DoublePack() = default;
  /// Sets all lanes to `value`.
  SLALOM_INLINE_CALLS DoublePack(double value) { DoubleOperations<T>::broadcast(value, v); }
  /// From a vector.
  SLALOM_INLINE DoublePack(const Vector& vector) : v(vector) {}
  SLALOM_INLINE DoublePack(const DoublePack& other) : v(other.v) {}
  SLALOM_INLINE DoublePack& operator=(const DoublePack& other) {
    v = other.v;
    return *this;
  }

  /// Reads `lanes` values.
  SLALOM_INLINE static DoublePack load(const double* from) {
    DoublePack p;
    std::memcpy(&p.v, from, sizeof p.v);
    return p;
  }
  /// Writes `lanes` values.
  SLALOM_INLINE void store(double* to) const { std::memcpy(to, &v, sizeof v); }
  /// Reads from[index] in each lane.
  SLALOM_INLINE_CALLS static DoublePack gather(const double* from, const Int& index) {
    DoublePack p;
    DoubleOperations<T>::gather(from, index, p.v);
    return p;
  }

  SLALOM_INLINE friend DoublePack operator+(const DoublePack& a, const DoublePack& b) {
    return DoublePack(a.v + b.v);
  }
  SLALOM_INLINE friend DoublePack operator-(const DoublePack& a, const DoublePack& b) {
    return DoublePack(a.v - b.v);
  }
  SLALOM_INLINE friend DoublePack operator*(const DoublePack& a, const DoublePack& b) {
    Vector product = a.v * b.v;
    SLALOM_ROUND(product);
    return DoublePack(product);
  }
  SLALOM_INLINE friend DoublePack operator/(const DoublePack& a, const DoublePack& b) {
    return DoublePack(a.v / b.v);
  }
  SLALOM_INLINE friend DoublePack operator-(const DoublePack& a) { return DoublePack(-a.v); }
  SLALOM_INLINE_CALLS friend DoubleMask<T> operator<(const DoublePack& a, const DoublePack& b) {
    DoubleMask<T> r;
    DoubleOperations<T>::less(a.v, b.v, r.v);
    return r;
  }
  SLALOM_INLINE_CALLS friend DoubleMask<T> operator<=(const DoublePack& a, const DoublePack& b) {
    DoubleMask<T> r;
    DoubleOperations<T>::less_or_equal(a.v, b.v, r.v);
    return r;
  }
  SLALOM_INLINE_CALLS friend DoubleMask<T> operator>(const DoublePack& a, const DoublePack& b) {
    return b < a;
  }
  SLALOM_INLINE_CALLS friend DoubleMask<T> operator>=(const DoublePack& a, const DoublePack& b) {
    return b <= a;
  }
};

/// `a` in the lanes where the condition holds, else `b`.
template <class T>
SLALOM_INLINE_CALLS DoublePack<T> select(const DoubleMask<T>& condition, const DoublePack<T>& a,
                                         const std::type_identity_t<DoublePack<T>>& b) {
  DoublePack<T> r;
  DoubleOperations<T>::select(condition.v, a.v, b.v, r.v);
  return r;
}
/// Whether any lane is set.
template <class T>
SLALOM_INLINE_CALLS bool any(const DoubleMask<T>& mask) {
  return DoubleOperations<T>::any(mask.v);
}
/// Rounded towards zero to integers; |x| < 2^31.
template <class T>
SLALOM_INLINE typename DoublePack<T>::Int truncate(const DoublePack<T>& x) {
  return __builtin_convertvector(x.v, typename DoublePack<T>::Int);
}

}  // namespace slalom::simd
