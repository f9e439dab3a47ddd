#pragma once

#include "slalom/core/pack/math.hpp"

/// Further mathematics on packs, made of the functions of pack/math.hpp. Accuracy: core/math.hpp. Polynomials
/// of tanh, sinh and asin: S. L. Moshier's Cephes library (tanhf, sinhf, asinf).
namespace slalom {

/// Whether all lanes are set.
template <class Target>
SLALOM_INLINE_CALLS bool all(const simd::Mask<Target>& mask) {
  return !any(!mask);
}

/// The largest integer that is not above x; |x| < 2^22.
template <class Target>
SLALOM_INLINE Pack<Target> floor(const Pack<Target>& x) {
  using F = Pack<Target>;
  const F nearest = round(x);
  return nearest - select(nearest > x, F(1.0f), F(0.0f));
}
/// The smallest integer that is not below x; |x| < 2^22.
template <class Target>
SLALOM_INLINE Pack<Target> ceil(const Pack<Target>& x) {
  using F = Pack<Target>;
  const F nearest = round(x);
  return nearest + select(nearest < x, F(1.0f), F(0.0f));
}
/// `magnitude` with the sign of `sign`, which may be that of a zero.
template <class Target>
SLALOM_INLINE Pack<Target> copysign(const Pack<Target>& magnitude,
                                    const std::type_identity_t<Pack<Target>>& sign) {
  using I = typename simd::IntPack<Target>::Vector;
  using V = typename Pack<Target>::Vector;
  const I bits = (reinterpret_cast<I>(magnitude.v) & 0x7fffffff) |
                 (reinterpret_cast<I>(sign.v) & static_cast<std::int32_t>(0x80000000u));
  return Pack<Target>(reinterpret_cast<V>(bits));
}
/// The remainder of x / y with the sign of x, as of std::fmod; |x / y| < 2^22.
template <class Target>
SLALOM_INLINE Pack<Target> fmod(const Pack<Target>& x, const std::type_identity_t<Pack<Target>>& y) {
  using F = Pack<Target>;
  const F a = abs(x), b = abs(y);
  F rest = a - floor(a / b) * b;
  // The quotient may have been rounded up or down to the next integer.
  rest = select(rest < F(0.0f), rest + b, rest);
  rest = select(rest >= b, rest - b, rest);
  return copysign(rest, x);
}
/// -1, 0 or 1.
template <class Target>
SLALOM_INLINE Pack<Target> sign(const Pack<Target>& x) {
  using F = Pack<Target>;
  return select(x > F(0.0f), F(1.0f), select(x < F(0.0f), F(-1.0f), F(0.0f)));
}

/// 2^x; 0 below -126, infinite from 128 on.
template <class Target>
SLALOM_INLINE Pack<Target> exp2(const Pack<Target>& x) {
  using F = Pack<Target>;
  using I = typename simd::IntPack<Target>::Vector;
  using V = typename F::Vector;
  const F bounded = min(max(x, F(-126.0f)), F(127.99999f));
  const F n = floor(bounded);
  const F part = exp((bounded - n) * F(0.693147181f));
  const I exponent = __builtin_convertvector(n.v, I) << 23;
  const F scaled = F(reinterpret_cast<V>(reinterpret_cast<I>(part.v) + exponent));
  const F low = select(x < F(-126.0f), F(0.0f), scaled);
  const F high = select(x >= F(128.0f), F(__builtin_inff()), low);
  return select(x == x, high, x);  // NaN stays NaN  NOLINT(misc-redundant-expression)
}
/// log(1 + x), accurate near 0 as well; -infinity at -1, NaN below.
template <class Target>
SLALOM_INLINE Pack<Target> log1p(const Pack<Target>& x) {
  using F = Pack<Target>;
  const F u = F(1.0f) + x, logarithm = log(u);
  const F lost = x - (u - F(1.0f));  // loss of u by rounding
  const F corrected = select(u == F(1.0f), x, logarithm + lost / u);
  return select((u > F(0.0f)) & (u < F(__builtin_inff())), corrected, logarithm);
}
/// x^y. Of a negative x it is a number only for integer y with |y| < 2^22.
template <class Target>
SLALOM_INLINE Pack<Target> pow(const Pack<Target>& x, const std::type_identity_t<Pack<Target>>& y) {
  using F = Pack<Target>;
  const F magnitude = exp(y * log(abs(x)));
  const F whole = floor(y), half = F(0.5f) * whole;
  const auto is_whole = whole == y, is_odd = is_whole & (floor(half) < half);
  const F negative = select(is_whole, select(is_odd, -magnitude, magnitude), F(__builtin_nanf("")));
  const F result = select(x < F(0.0f), negative, magnitude);
  return select(y == F(0.0f), F(1.0f), result);
}
/// The length of (x, y), without overflow where the length is a float32.
template <class Target>
SLALOM_INLINE Pack<Target> hypot(const Pack<Target>& x, const std::type_identity_t<Pack<Target>>& y) {
  using F = Pack<Target>;
  const F a = abs(x), b = abs(y), large = max(a, b), small = min(a, b);
  const F ratio = select(large > F(0.0f), small / large, F(0.0f));
  return large * sqrt(F(1.0f) + ratio * ratio);
}
/// The cube root.
template <class Target>
SLALOM_INLINE Pack<Target> cbrt(const Pack<Target>& x) {
  using F = Pack<Target>;
  const F a = abs(x);
  const F start = exp(log(a) * F(0.333333333f));
  // A step of Newton's method removes the error of the logarithm.
  const F root = start - (start - a / (start * start)) * F(0.333333333f);
  return copysign(select(a > F(0.0f), root, a), x);
}

/// Hyperbolic tangent.
template <class Target>
SLALOM_INLINE Pack<Target> tanh(const Pack<Target>& x) {
  using F = Pack<Target>;
  const F a = abs(x), z = x * x;
  const F p = polynomial(z, -5.70498872745e-3f, 2.06390887954e-2f, -5.37397155531e-2f, 1.33314422036e-1f,
                         -3.33332819422e-1f);
  const F near = x + x * z * p;
  const F far = F(1.0f) - F(2.0f) / (exp(a + a) + F(1.0f));
  return select(a < F(0.625f), near, copysign(far, x));
}
/// Hyperbolic sine; |x| < 88.
template <class Target>
SLALOM_INLINE Pack<Target> sinh(const Pack<Target>& x) {
  using F = Pack<Target>;
  const F a = abs(x), z = x * x, e = exp(a);
  const F p = polynomial(z, 2.03721912945e-4f, 8.33028376239e-3f, 1.66667160211e-1f);
  const F near = x + x * z * p;
  return select(a < F(1.0f), near, copysign(F(0.5f) * (e - F(1.0f) / e), x));
}
/// Hyperbolic cosine; |x| < 88.
template <class Target>
SLALOM_INLINE Pack<Target> cosh(const Pack<Target>& x) {
  using F = Pack<Target>;
  const F e = exp(abs(x));
  return F(0.5f) * (e + F(1.0f) / e);
}

/// Arc sine, rad; |x| <= 1.
template <class Target>
SLALOM_INLINE Pack<Target> asin(const Pack<Target>& x) {
  using F = Pack<Target>;
  const F a = abs(x);
  const auto steep = a > F(0.5f);
  const F z = select(steep, F(0.5f) * (F(1.0f) - a), a * a), s = select(steep, sqrt(z), a);
  const F p =
      polynomial(z, 4.2163199048e-2f, 2.4181311049e-2f, 4.5470025998e-2f, 7.4953002686e-2f, 1.6666752422e-1f);
  const F angle = s + s * z * p;
  return copysign(select(steep, F(1.57079632679f) - (angle + angle), angle), x);
}
/// Arc cosine, rad; |x| <= 1.
template <class Target>
SLALOM_INLINE Pack<Target> acos(const Pack<Target>& x) {
  using F = Pack<Target>;
  // Near 1 by the half angle, since pi/2 - asin(x) would lose the digits of a small angle.
  const F half = asin(sqrt(max(F(0.5f) * (F(1.0f) - abs(x)), F(0.0f))));
  const F angle = half + half;
  const F steep = select(x > F(0.0f), angle, F(3.14159265359f) - angle);
  const F result = select(abs(x) > F(0.5f), steep, F(1.57079632679f) - asin(x));
  return select(abs(x) <= F(1.0f), result, F(__builtin_nanf("")));
}
/// The angle of the vector (x, y), rad, in [-pi, pi]; the signs of zeros count as in std::atan2.
template <class Target>
SLALOM_INLINE Pack<Target> atan2(const Pack<Target>& y, const std::type_identity_t<Pack<Target>>& x) {
  using F = Pack<Target>;
  const F a = abs(x), b = abs(y), large = max(a, b);
  const F ratio = select(large > F(0.0f), min(a, b) / large, F(0.0f));
  const F acute = atan(ratio);
  const F first = select(b > a, F(1.57079632679f) - acute, acute);
  const auto left = copysign(F(1.0f), x) < F(0.0f);
  return copysign(select(left, F(3.14159265359f) - first, first), y);
}

/// a b + c, rounded once where the instruction set has fused multiply-adds.
template <class Target>
SLALOM_INLINE Pack<Target> fma(const Pack<Target>& a, const std::type_identity_t<Pack<Target>>& b,
                               const std::type_identity_t<Pack<Target>>& c) {
  return a * b + c;
}

}  // namespace slalom
