#pragma once

#include "slalom/core/simd.hpp"

/// Mathematics on packs: the functions of math.hpp, lane by lane. Accuracy: math.hpp.
namespace slalom {

using simd::Pack;

/// Functions of packs that compilers need to be told, lane by lane.
#define SLALOM_PACK_FUNCTION(name)                               \
  template <class Target>                                        \
  SLALOM_INLINE_CALLS Pack<Target> name(const Pack<Target>& x) { \
    Pack<Target> r;                                              \
    simd::Operations<Target>::name(x.v, r.v);                    \
    return r;                                                    \
  }
SLALOM_PACK_FUNCTION(sqrt)
SLALOM_PACK_FUNCTION(reciprocal_sqrt)  // 4 units in the last place; x > 0; bits depend on the instruction set
SLALOM_PACK_FUNCTION(round)            // nearest integer, ties to even; |x| < 2^22
#undef SLALOM_PACK_FUNCTION

/// Functions of two packs, lane by lane.
#define SLALOM_PACK_FUNCTION(name)                                                     \
  template <class Target>                                                              \
  SLALOM_INLINE_CALLS Pack<Target> name(const Pack<Target>& a,                         \
                                        const std::type_identity_t<Pack<Target>>& b) { \
    Pack<Target> r;                                                                    \
    simd::Operations<Target>::name(a.v, b.v, r.v);                                     \
    return r;                                                                          \
  }
SLALOM_PACK_FUNCTION(min)
SLALOM_PACK_FUNCTION(max)
#undef SLALOM_PACK_FUNCTION

/// `a` in lanes where the condition is true, else `b`.
template <class Target>
SLALOM_INLINE_CALLS Pack<Target> select(const simd::Mask<Target>& condition, const Pack<Target>& a,
                                        const std::type_identity_t<Pack<Target>>& b) {
  Pack<Target> r;
  simd::Operations<Target>::select(condition.v, a.v, b.v, r.v);
  return r;
}
/// Absolute value, lane by lane.
template <class Target>
SLALOM_INLINE Pack<Target> abs(const Pack<Target>& x) {
  using I = typename simd::IntPack<Target>::Vector;
  return Pack<Target>(reinterpret_cast<typename Pack<Target>::Vector>(reinterpret_cast<I>(x.v) & 0x7fffffff));
}

/// Whether any lane is set.
template <class Target>
SLALOM_INLINE_CALLS bool any(const simd::Mask<Target>& mask) {
  return simd::Operations<Target>::any(mask.v);
}
/// Rounded towards zero to integers; |x| < 2^31.
template <class Target>
SLALOM_INLINE simd::IntPack<Target> truncate(const Pack<Target>& x) {
  using I = typename simd::IntPack<Target>::Vector;
  return simd::IntPack<Target>(__builtin_convertvector(x.v, I));
}
/// Integers to float32, rounded to nearest.
template <class Target>
SLALOM_INLINE Pack<Target> to_float(const simd::IntPack<Target>& x) {
  return Pack<Target>(__builtin_convertvector(x.v, typename Pack<Target>::Vector));
}

/// The product rounded to the nearest integer, for products within 2^22: adding 1.5 * 2^23 rounds the
/// fraction away and leaves the integer in the low bits of the sum (`bits`, to be used modulo a power of two
/// up to 2^22). This is cheaper than a rounding instruction and a conversion.
template <class Target>
SLALOM_INLINE Pack<Target> rounded_product(const Pack<Target>& x, float factor,
                                           typename simd::IntPack<Target>::Vector& bits) {
  using F = Pack<Target>;
  const F magic(12582912.0f);
  const F sum = x * F(factor) + magic;
  bits = reinterpret_cast<typename simd::IntPack<Target>::Vector>(sum.v);
  return sum - magic;
}

/// Sine and cosine of an angle in [-pi/2, pi/2], such as a steering angle. This is cheaper than `sin_cos`,
/// since the angle needs no reduction. The polynomials interpolate at Chebyshev nodes of the squared angle,
/// weighted towards the end of its range.
template <class Target>
SLALOM_INLINE void sin_cos_half_turn(const Pack<Target>& x, Pack<Target>& s, Pack<Target>& c) {
  using F = Pack<Target>;
  const F x2 = x * x;
  s = x +
      x * x2 *
          (F(-0.166666643f) + x2 * (F(8.33317683e-3f) + x2 * (F(-1.98170522e-4f) + x2 * F(2.62108806e-6f))));
  c = (F(1.0f) - F(0.5f) * x2) +
      x2 * x2 *
          (F(4.16666647e-2f) + x2 * (F(-1.38887578e-3f) + x2 * (F(2.4781316e-5f) + x2 * F(-2.64315039e-7f))));
}
/// Sine and cosine together. The angle is reduced to [-pi/2, pi/2]: this needs longer polynomials than a
/// reduction to [-pi/4, pi/4], but no exchange of sine and cosine.
template <class Target>
SLALOM_INLINE void sin_cos(const Pack<Target>& x, Pack<Target>& s, Pack<Target>& c) {
  using F = Pack<Target>;
  using I = typename simd::IntPack<Target>::Vector;
  using V = typename F::Vector;
  I bits;
  const F half_turns = rounded_product(x, 0.318309886f, bits);
  F r;
  if constexpr (Target::fused) {
    simd::Operations<Target>::subtract_product(x.v, half_turns.v, F(3.14159274f).v, r.v);
    r = r + half_turns * F(8.74227766e-8f);
  } else {  // pi in three parts, the first two short enough for exact products
    r = x - half_turns * F(3.140625f);
    r = r - half_turns * F(9.67502593994140625e-4f);
    r = r - half_turns * F(1.509957990978376e-7f);
  }
  sin_cos_half_turn(r, s, c);
  const I sign = bits << 31;
  s = F(reinterpret_cast<V>(reinterpret_cast<I>(s.v) ^ sign));
  c = F(reinterpret_cast<V>(reinterpret_cast<I>(c.v) ^ sign));
}
/// Sine, lane by lane.
template <class Target>
SLALOM_INLINE Pack<Target> sin(const Pack<Target>& x) {
  Pack<Target> s, c;
  sin_cos(x, s, c);
  return s;
}
/// Cosine, lane by lane.
template <class Target>
SLALOM_INLINE Pack<Target> cos(const Pack<Target>& x) {
  Pack<Target> s, c;
  sin_cos(x, s, c);
  return c;
}
/// Tangent, lane by lane.
template <class Target>
SLALOM_INLINE Pack<Target> tan(const Pack<Target>& x) {
  Pack<Target> s, c;
  sin_cos(x, s, c);
  return s / c;
}

/// The polynomial of x with these coefficients, that of the highest power first.
template <class F, class... Coefficients>
SLALOM_INLINE F polynomial(const F& x, float highest, Coefficients... others) {
  F sum(highest);
  ((sum = sum * x + F(others)), ...);
  return sum;
}

/// e^x; 0 below -87.3, e^88.3 between 88.3 and 88.7, infinite above 88.7.
template <class Target>
SLALOM_INLINE Pack<Target> exp(const Pack<Target>& x) {
  using F = Pack<Target>;
  using I = typename simd::IntPack<Target>::Vector;
  using V = typename F::Vector;
  const F bounded = min(max(x, F(-87.3f)), F(88.3f));
  const F n = round(bounded * F(1.44269504f));
  F r = bounded - n * F(0.693359375f);
  r = r - n * F(-2.12194440e-4f);
  const F p = polynomial(r, 1.9875691500e-4f, 1.3981999507e-3f, 8.3334519073e-3f, 4.1665795894e-2f,
                         1.6666665459e-1f, 5.0000001201e-1f);
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
  using U = typename simd::detail::VectorTypes<Target::lanes>::Unsigned;
  const U bits = reinterpret_cast<U>(x.v);  // unsigned, since below 0 the differences overflow
  const I e = reinterpret_cast<I>(bits - 0x3f3504f3u) >> 23;
  const F m = F(reinterpret_cast<V>(bits - (reinterpret_cast<U>(e) << 23))) - F(1.0f);
  const F n = F(__builtin_convertvector(e, V));
  const F m2 = m * m;
  const F p =
      polynomial(m, 7.0376836292e-2f, -1.1514610310e-1f, 1.1676998740e-1f, -1.2420140846e-1f,
                 1.4249322787e-1f, -1.6668057665e-1f, 2.0000714765e-1f, -2.4999993993e-1f, 3.3333331174e-1f);
  const F y = m * m2 * p + n * F(-2.12194440e-4f) - F(0.5f) * m2;
  const F result = m + y + n * F(0.693359375f);
  const F at_zero = select(x <= F(0.0f), F(-__builtin_inff()), result);
  const F below = select(x < F(0.0f), F(__builtin_nanf("")), at_zero);
  return select(x >= F(__builtin_inff()), x, below);
}

/// Arc tangent, lane by lane.
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

}  // namespace slalom
