#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "slalom/core/simd_operations.hpp"

/// Mathematics that a problem may use, written once for `float`, `double` and packs of SIMD lanes: call these
/// by their unqualified or `slalom::` names instead of those in `std`.
///
/// Accuracy on packs, against double: sin, cos, tan, exp, log, atan within 3 units in the last place or 1e-7,
/// whichever is larger (angles up to 8000 rad). Polynomials: S. L. Moshier's Cephes library (sinf, cosf,
/// expf, logf, atanf).
namespace slalom {

using simd::Pack;

/// The truth value that goes with a scalar type: `bool`, or one per lane.
template <class T>
struct MaskOf {
  using type = bool;
};
template <class Target>
struct MaskOf<Pack<Target>> {
  using type = simd::Mask<Target>;
};
template <class T>
using mask_t = typename MaskOf<T>::type;

/// True for the types a rollout runs on.
template <class T>
inline constexpr bool is_pack = false;
template <class Target>
inline constexpr bool is_pack<Pack<Target>> = true;

// --- scalars
// -------------------------------------------------------------------------------------------------------
template <class T>
concept Scalar = std::is_same_v<T, float> || std::is_same_v<T, double>;

template <Scalar T>
T sin(T x) {
  return std::sin(x);
}
template <Scalar T>
T cos(T x) {
  return std::cos(x);
}
template <Scalar T>
T tan(T x) {
  return std::tan(x);
}
template <Scalar T>
T exp(T x) {
  return std::exp(x);
}
template <Scalar T>
T log(T x) {
  return std::log(x);
}
template <Scalar T>
T atan(T x) {
  return std::atan(x);
}
template <Scalar T>
T sqrt(T x) {
  return std::sqrt(x);
}
template <Scalar T>
T abs(T x) {
  return std::abs(x);
}
/// To the nearest integer, ties to even.
template <Scalar T>
T round(T x) {
  return std::nearbyint(x);
}
template <Scalar T>
T reciprocal_sqrt(T x) {
  return T(1) / std::sqrt(x);
}
template <Scalar T>
T min(T a, std::type_identity_t<T> b) {
  return a < b ? a : b;
}
template <Scalar T>
T max(T a, std::type_identity_t<T> b) {
  return a > b ? a : b;
}
/// `a` where the condition holds, else `b`.
template <Scalar T>
T select(bool condition, T a, std::type_identity_t<T> b) {
  return condition ? a : b;
}
template <Scalar T>
void sin_cos(T x, T& s, T& c) {
  s = std::sin(x);
  c = std::cos(x);
}

// --- packs
// ---------------------------------------------------------------------------------------------------------
template <class Target>
SLALOM_INLINE Pack<Target> min(const Pack<Target>& a, const std::type_identity_t<Pack<Target>>& b) {
  Pack<Target> r;
  simd::Operations<Target>::min(a.v, b.v, r.v);
  return r;
}
template <class Target>
SLALOM_INLINE Pack<Target> max(const Pack<Target>& a, const std::type_identity_t<Pack<Target>>& b) {
  Pack<Target> r;
  simd::Operations<Target>::max(a.v, b.v, r.v);
  return r;
}
template <class Target>
SLALOM_INLINE Pack<Target> select(const simd::Mask<Target>& condition, const Pack<Target>& a,
                                  const std::type_identity_t<Pack<Target>>& b) {
  return Pack<Target>(condition.v ? a.v : b.v);
}
template <class Target>
SLALOM_INLINE Pack<Target> sqrt(const Pack<Target>& x) {
  Pack<Target> r;
  simd::Operations<Target>::sqrt(x.v, r.v);
  return r;
}
/// 1/sqrt(x), within 2 units in the last place; x > 0.
template <class Target>
SLALOM_INLINE Pack<Target> reciprocal_sqrt(const Pack<Target>& x) {
  Pack<Target> r;
  simd::Operations<Target>::reciprocal_sqrt(x.v, r.v);
  return r;
}
template <class Target>
SLALOM_INLINE Pack<Target> round(const Pack<Target>& x) {
  Pack<Target> r;
  simd::Operations<Target>::round(x.v, r.v);
  return r;
}
template <class Target>
SLALOM_INLINE Pack<Target> abs(const Pack<Target>& x) {
  using I = typename simd::IntPack<Target>::Vector;
  return Pack<Target>(reinterpret_cast<typename Pack<Target>::Vector>(reinterpret_cast<I>(x.v) & 0x7fffffff));
}

/// Sine and cosine together: reduced by multiples of pi/2 in two parts, then a polynomial of each on [-pi/4,
/// pi/4].
template <class Target>
SLALOM_INLINE void sin_cos(const Pack<Target>& x, Pack<Target>& s, Pack<Target>& c) {
  using F = Pack<Target>;
  using I = typename simd::IntPack<Target>::Vector;
  using V = typename F::Vector;
  const F quarter_turns = round(x * F(0.636619772f));
  F r;
  if constexpr (Target::fused) {
    r = x - quarter_turns * F(1.57079637f);
    r = r + quarter_turns * F(4.37113883e-8f);
  } else {  // pi/2 in three parts, the first two short enough for exact products
    r = x - quarter_turns * F(1.5703125f);
    r = r - quarter_turns * F(4.837512969970703125e-4f);
    r = r - quarter_turns * F(7.54978995489188216e-8f);
  }
  const F r2 = r * r;
  const F sine = r + r * r2 * (F(-1.6666654611e-1f) + r2 * (F(8.3321608736e-3f) + r2 * F(-1.9515295891e-4f)));
  const F cosine = (F(1.0f) - F(0.5f) * r2) +
                   r2 * r2 * (F(4.166664568e-2f) + r2 * (F(-1.388731625e-3f) + r2 * F(2.443315712e-5f)));
  const I q = __builtin_convertvector(quarter_turns.v, I);
  const I odd = -(q & 1);
  const V a = odd ? cosine.v : sine.v;
  const V b = odd ? sine.v : cosine.v;
  constexpr int sign = static_cast<int>(0x80000000u);
  s = F(reinterpret_cast<V>(reinterpret_cast<I>(a) ^ ((q << 30) & sign)));
  c = F(reinterpret_cast<V>(reinterpret_cast<I>(b) ^ (((q + 1) << 30) & sign)));
}
template <class Target>
SLALOM_INLINE Pack<Target> sin(const Pack<Target>& x) {
  Pack<Target> s, c;
  sin_cos(x, s, c);
  return s;
}
template <class Target>
SLALOM_INLINE Pack<Target> cos(const Pack<Target>& x) {
  Pack<Target> s, c;
  sin_cos(x, s, c);
  return c;
}
template <class Target>
SLALOM_INLINE Pack<Target> tan(const Pack<Target>& x) {
  Pack<Target> s, c;
  sin_cos(x, s, c);
  return s / c;
}

/// e^x; 0 below -87.3, infinite above 88.7.
template <class Target>
SLALOM_INLINE Pack<Target> exp(const Pack<Target>& x) {
  using F = Pack<Target>;
  using I = typename simd::IntPack<Target>::Vector;
  using V = typename F::Vector;
  const F bounded = min(max(x, F(-87.3f)), F(88.3f));
  const F n = round(bounded * F(1.44269504f));
  F r = bounded - n * F(0.693359375f);
  r = r - n * F(-2.12194440e-4f);
  F p = F(1.9875691500e-4f);
  p = p * r + F(1.3981999507e-3f);
  p = p * r + F(8.3334519073e-3f);
  p = p * r + F(4.1665795894e-2f);
  p = p * r + F(1.6666665459e-1f);
  p = p * r + F(5.0000001201e-1f);
  const F e = r * r * p + r + F(1.0f);
  const I exponent = __builtin_convertvector(n.v, I) << 23;
  const F scaled = F(reinterpret_cast<V>(reinterpret_cast<I>(e.v) + exponent));
  const F low = select(x < F(-87.3f), F(0.0f), scaled);
  return select(x > F(88.7f), F(__builtin_inff()), low);
}

/// Natural logarithm of a positive, normal x; -infinity at 0, NaN below.
template <class Target>
SLALOM_INLINE Pack<Target> log(const Pack<Target>& x) {
  using F = Pack<Target>;
  using I = typename simd::IntPack<Target>::Vector;
  using V = typename F::Vector;
  const I bits = reinterpret_cast<I>(x.v);
  const I e = (bits - 0x3f3504f3) >> 23;
  const F m = F(reinterpret_cast<V>(bits - (e << 23))) - F(1.0f);
  const F n = F(__builtin_convertvector(e, V));
  const F m2 = m * m;
  F p = F(7.0376836292e-2f);
  p = p * m + F(-1.1514610310e-1f);
  p = p * m + F(1.1676998740e-1f);
  p = p * m + F(-1.2420140846e-1f);
  p = p * m + F(1.4249322787e-1f);
  p = p * m + F(-1.6668057665e-1f);
  p = p * m + F(2.0000714765e-1f);
  p = p * m + F(-2.4999993993e-1f);
  p = p * m + F(3.3333331174e-1f);
  const F y = m * m2 * p + n * F(-2.12194440e-4f) - F(0.5f) * m2;
  const F result = m + y + n * F(0.693359375f);
  const F at_zero = select(x <= F(0.0f), F(-__builtin_inff()), result);
  const F below = select(x < F(0.0f), F(__builtin_nanf("")), at_zero);
  return select(x >= F(__builtin_inff()), x, below);
}

template <class Target>
SLALOM_INLINE Pack<Target> atan(const Pack<Target>& x) {
  using F = Pack<Target>;
  const F a = abs(x);
  const auto steep = a > F(2.414213562f);
  const auto middle = a > F(0.4142135623f);
  const F numerator = select(steep, F(-1.0f), select(middle, a - F(1.0f), a));
  const F denominator = select(steep, a, select(middle, a + F(1.0f), F(1.0f)));
  const F base = select(steep, F(1.57079632679f), select(middle, F(0.78539816f), F(0.0f)));
  const F z = numerator / denominator;
  const F z2 = z * z;
  const F p = F(-3.33329491539e-1f) +
              z2 * (F(1.99777106478e-1f) + z2 * (F(-1.38776856032e-1f) + z2 * F(8.05374449538e-2f)));
  const F magnitude = base + z + z * z2 * p;
  return select(x < F(0.0f), -magnitude, magnitude);
}

// --- for either
// ----------------------------------------------------------------------------------------------------
template <class T>
SLALOM_INLINE T clamp(const T& x, const std::type_identity_t<T>& low, const std::type_identity_t<T>& high) {
  return min(max(x, low), high);
}

/// The angle shifted by whole turns into [-pi, pi].
template <class T>
SLALOM_INLINE T wrap_angle(const T& angle) {
  return angle - round(angle * T(0.15915494309189535)) * T(6.283185307179586);
}

template <class T>
SLALOM_INLINE T square(const T& x) {
  return x * x;
}

}  // namespace slalom
