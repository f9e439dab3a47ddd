#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "slalom/core/pack/gpu.hpp"
#include "slalom/core/pack/pair.hpp"

/// Mathematics that a problem may use, written once for `float`, `double` and packs of SIMD lanes: call these
/// by their unqualified or `slalom::` names instead of those in `std`.
///
/// Accuracy on packs, compared with double: sin, cos, exp, log, atan within 3 units in the last place or
/// 2e-7, whichever is larger (angles up to 8000 rad; exp up to 88.3); tan is the quotient of sin and cos. The
/// polynomials of exp, log and atan are those of S. L. Moshier's Cephes library (expf, logf, atanf); those of
/// sin and cos were made for Slalom. In units in the last place: cbrt, hypot 2; tanh, exp2 3; asin, acos,
/// atan2, sinh, cosh (|x| < 80), log1p 4; pow 4 + |y log x|; fmod one of the dividend; floor, ceil, sign,
/// copysign exact (floor, ceil: |x| < 2^22).
namespace slalom {

/// The truth value that goes with a scalar type: `bool`, or one per lane.
template <class T>
struct MaskOf {
  using type = bool;  ///< mask of scalars
};
/// The type of comparisons of packs.
template <class Target>
struct MaskOf<Pack<Target>> {
  using type = simd::Mask<Target>;  ///< mask of packs
};
/// Type of comparisons of T: `bool`, or a mask with one lane for each value.
template <class T>
using mask_t = typename MaskOf<T>::type;

/// Whether a type is a pack of SIMD lanes.
template <class T>
inline constexpr bool is_pack = false;
/// True for packs, and for pairs of them.
template <class Target>
inline constexpr bool is_pack<Pack<Target>> = true;
/// Whether a type is a pair of packs.
template <class T>
inline constexpr bool is_pair = false;
/// True for pairs.
template <class Target>
inline constexpr bool is_pair<PackPair<Target>> = true;

// --- scalars
template <class T>
concept Scalar = std::is_same_v<T, float> || std::is_same_v<T, double>;  ///< `float` and `double`

/// Sine of an angle, rad.
template <Scalar T>
T sin(T x) {
  if constexpr (detail::gpu::computes<T>) return detail::gpu::sin(x);
  return std::sin(x);
}
/// Cosine of an angle, rad.
template <Scalar T>
T cos(T x) {
  if constexpr (detail::gpu::computes<T>) return detail::gpu::cos(x);
  return std::cos(x);
}
/// Functions of one number that the standard library has.
#define SLALOM_STANDARD_FUNCTION(name, standard) \
  template <Scalar T>                            \
  T name(T x) {                                  \
    return std::standard(x);                     \
  }
SLALOM_STANDARD_FUNCTION(tan, tan)          // tangent of an angle, rad
SLALOM_STANDARD_FUNCTION(exp, exp)          // e^x
SLALOM_STANDARD_FUNCTION(log, log)          // natural logarithm
SLALOM_STANDARD_FUNCTION(atan, atan)        // arc tangent, rad
SLALOM_STANDARD_FUNCTION(sqrt, sqrt)        // square root
SLALOM_STANDARD_FUNCTION(abs, abs)          // absolute value
SLALOM_STANDARD_FUNCTION(round, nearbyint)  // nearest integer, ties to even
SLALOM_STANDARD_FUNCTION(tanh, tanh)        // hyperbolic tangent
SLALOM_STANDARD_FUNCTION(sinh, sinh)        // hyperbolic sine
SLALOM_STANDARD_FUNCTION(cosh, cosh)        // hyperbolic cosine
SLALOM_STANDARD_FUNCTION(asin, asin)        // arc sine, rad
SLALOM_STANDARD_FUNCTION(acos, acos)        // arc cosine, rad
SLALOM_STANDARD_FUNCTION(cbrt, cbrt)        // cube root
SLALOM_STANDARD_FUNCTION(exp2, exp2)        // 2^x
SLALOM_STANDARD_FUNCTION(log1p, log1p)      // log(1 + x), accurate near 0 as well
SLALOM_STANDARD_FUNCTION(floor, floor)      // largest integer that is not above x
SLALOM_STANDARD_FUNCTION(ceil, ceil)        // smallest integer that is not below x
#undef SLALOM_STANDARD_FUNCTION

/// Functions of two numbers that the standard library has.
#define SLALOM_STANDARD_FUNCTION(name)     \
  template <Scalar T>                      \
  T name(T x, std::type_identity_t<T> y) { \
    return std::name(x, y);                \
  }
SLALOM_STANDARD_FUNCTION(atan2)     // angle of the vector (y, x), rad
SLALOM_STANDARD_FUNCTION(pow)       // x^y
SLALOM_STANDARD_FUNCTION(hypot)     // length of (x, y)
SLALOM_STANDARD_FUNCTION(fmod)      // remainder of x / y with the sign of x
SLALOM_STANDARD_FUNCTION(copysign)  // x with the sign of y
#undef SLALOM_STANDARD_FUNCTION

/// 1 / sqrt(x).
template <Scalar T>
T reciprocal_sqrt(T x) {
  return T(1) / std::sqrt(x);
}
/// The smaller value.
template <Scalar T>
T min(T a, std::type_identity_t<T> b) {
  return a < b ? a : b;
}
/// The larger value.
template <Scalar T>
T max(T a, std::type_identity_t<T> b) {
  return a > b ? a : b;
}
/// `a` where the condition holds, else `b`.
template <Scalar T>
T select(bool condition, T a, std::type_identity_t<T> b) {
  return condition ? a : b;
}
/// a b + c, rounded once.
template <Scalar T>
T fma(T a, std::type_identity_t<T> b, std::type_identity_t<T> c) {
  return std::fma(a, b, c);
}
/// -1, 0 or 1.
template <Scalar T>
T sign(T x) {
  return static_cast<T>((x > T(0)) - (x < T(0)));
}
/// Whether the condition holds; of packs, in any lane.
inline bool any(bool condition) {
  return condition;
}
/// Whether the condition holds; of packs, in all lanes.
inline bool all(bool condition) {
  return condition;
}
/// Sine and cosine of an angle, rad.
template <Scalar T>
void sin_cos(T x, T& s, T& c) {
  if constexpr (detail::gpu::computes<T>) return detail::gpu::sin_cos(x, s, c);
  s = std::sin(x);
  c = std::cos(x);
}
/// Refuses a call that expects both as a result, with words.
template <class T>
auto sin_cos(const T& x) {
  static_assert(sizeof(T) == 0, "slalom: sin_cos writes to its arguments: T s, c; slalom::sin_cos(x, s, c);");
  return x;
}

/// Sine and cosine of an angle in [-pi/2, pi/2], rad.
template <Scalar T>
void sin_cos_half_turn(T x, T& s, T& c) {
  sin_cos(x, s, c);
}

// --- scalars and packs
/// `x`, limited to the bounds.
template <class T>
SLALOM_INLINE T clamp(const T& x, const std::type_identity_t<T>& low, const std::type_identity_t<T>& high) {
  return min(max(x, low), high);
}

/// The angle shifted by whole turns into [-pi, pi].
template <class T>
SLALOM_INLINE T wrap_angle(const T& angle) {
  if constexpr (is_pair<T>) {
    return {wrap_angle(angle.low), wrap_angle(angle.high)};
  } else if constexpr (is_pack<T>) {
    typename simd::IntPack<typename T::Target>::Vector turns;
    return angle - rounded_product(angle, 0.159154943f, turns) * T(6.28318531f);
  } else {
    return angle - round(angle * T(0.15915494309189535)) * T(6.283185307179586);
  }
}

/// a where t = 0, b where t = 1, on a line between and beyond.
template <class T>
SLALOM_INLINE T lerp(const T& a, const std::type_identity_t<T>& b, const std::type_identity_t<T>& t) {
  return a + t * (b - a);
}

/// The square of `x`.
template <class T>
SLALOM_INLINE T square(const T& x) {
  return x * x;
}

}  // namespace slalom
