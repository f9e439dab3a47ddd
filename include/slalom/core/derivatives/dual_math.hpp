#pragma once

#include "slalom/core/derivatives/dual.hpp"
#include "slalom/core/grid_view.hpp"
#include "slalom/core/math.hpp"

/// Mathematics on dual numbers: the functions of math.hpp, with their derivatives.
namespace slalom {

/// The type of comparisons of dual numbers.
template <class T, int N>
struct MaskOf<Dual<T, N>> {
  using type = DualMask;  ///< mask of dual numbers
};

namespace detail {

/// f(x), given its value and its derivative at x.
template <class T, int N>
Dual<T, N> chain(const Dual<T, N>& x, const T& value, const T& slope) {
  Dual<T, N> r;
  r.value = value;
  for (int i = 0; i < N; ++i) r.derivative[i] = slope * x.derivative[i];
  r.kink = x.kink;
  return r;
}
/// f(x) where f has no derivative, or an infinite one.
template <class T, int N>
Dual<T, N> without_slope(const Dual<T, N>& x, const T& value) {
  Dual<T, N> r(plain(value));
  r.kink = x.kink || !identical(x, Dual<T, N>(plain(x)));
  return r;
}
/// f(x), constant around x unless `jumps`.
template <class T, int N>
Dual<T, N> step_function(const Dual<T, N>& x, double value, bool jumps) {
  if (jumps) return without_slope(x, T(value));
  Dual<T, N> r(value);
  r.kink = x.kink;
  return r;
}

}  // namespace detail

/// Functions of one number: value and derivative at x.value, of which `r` is the value.
#define SLALOM_DUAL_FUNCTION(name, slope) \
  template <class T, int N>               \
  Dual<T, N> name(const Dual<T, N>& a) {  \
    const T x = a.value, r = name(x);     \
    return detail::chain(a, r, slope);    \
  }
SLALOM_DUAL_FUNCTION(sin, cos(x))
SLALOM_DUAL_FUNCTION(cos, -sin(x))
SLALOM_DUAL_FUNCTION(tan, T(1.0) + r * r)
SLALOM_DUAL_FUNCTION(exp, r)
SLALOM_DUAL_FUNCTION(exp2, T(0.6931471805599453) * r)
SLALOM_DUAL_FUNCTION(log, T(1.0) / x)
SLALOM_DUAL_FUNCTION(log1p, T(1.0) / (T(1.0) + x))
SLALOM_DUAL_FUNCTION(sinh, cosh(x))
SLALOM_DUAL_FUNCTION(cosh, sinh(x))
SLALOM_DUAL_FUNCTION(tanh, T(1.0) - r * r)
SLALOM_DUAL_FUNCTION(atan, T(1.0) / (T(1.0) + x * x))
SLALOM_DUAL_FUNCTION(reciprocal_sqrt, T(-0.5) * r / x)
#undef SLALOM_DUAL_FUNCTION

/// Sine and cosine of an angle, rad.
template <class T, int N>
void sin_cos(const Dual<T, N>& x, Dual<T, N>& s, Dual<T, N>& c) {
  s = sin(x);
  c = cos(x);
}
/// Sine and cosine of an angle in [-pi/2, pi/2], rad.
template <class T, int N>
void sin_cos_half_turn(const Dual<T, N>& x, Dual<T, N>& s, Dual<T, N>& c) {
  sin_cos(x, s, c);
}
/// Arc sine, rad.
template <class T, int N>
Dual<T, N> asin(const Dual<T, N>& x) {
  const T square = T(1.0) - x.value * x.value;
  if (detail::plain(square) == 0) return detail::without_slope(x, asin(x.value));
  return detail::chain(x, asin(x.value), T(1.0) / sqrt(square));
}
/// Arc cosine, rad.
template <class T, int N>
Dual<T, N> acos(const Dual<T, N>& x) {
  const T square = T(1.0) - x.value * x.value;
  if (detail::plain(square) == 0) return detail::without_slope(x, acos(x.value));
  return detail::chain(x, acos(x.value), T(-1.0) / sqrt(square));
}
/// Square root. At 0 the derivative is 0 and `kink` is set, since that of sqrt(x^2 + y^2) is not known there.
template <class T, int N>
Dual<T, N> sqrt(const Dual<T, N>& x) {
  const T root = sqrt(x.value);
  if (detail::plain(root) == 0) {
    Dual<T, N> zero(0.0);
    zero.kink = true;
    return zero;
  }
  return detail::chain(x, root, T(0.5) / root);
}
/// Cube root.
template <class T, int N>
Dual<T, N> cbrt(const Dual<T, N>& x) {
  const T root = cbrt(x.value);
  if (detail::plain(root) == 0) return detail::without_slope(x, root);
  return detail::chain(x, root, T(1.0 / 3.0) / (root * root));
}
/// The length of (x, y).
template <class T, int N>
Dual<T, N> hypot(const Dual<T, N>& x, const std::type_identity_t<Dual<T, N>>& y) {
  const T length = hypot(x.value, y.value);
  if (detail::plain(length) == 0) return detail::without_slope(x, length) + detail::without_slope(y, T(0.0));
  return Dual<T, N>::linear(x, x.value / length, y, y.value / length, length);
}
/// The angle of the vector (x, y), rad.
template <class T, int N>
Dual<T, N> atan2(const Dual<T, N>& y, const std::type_identity_t<Dual<T, N>>& x) {
  const T square = x.value * x.value + y.value * y.value, angle = atan2(y.value, x.value);
  if (detail::plain(square) == 0) return detail::without_slope(x, angle) + detail::without_slope(y, T(0.0));
  return Dual<T, N>::linear(y, x.value / square, x, -y.value / square, angle);
}
/// x^y.
template <class T, int N>
Dual<T, N> pow(const Dual<T, N>& x, const std::type_identity_t<Dual<T, N>>& y) {
  const T power = pow(x.value, y.value);
  const bool constant_exponent = detail::identical(y, Dual<T, N>(detail::plain(y)));
  const double base = detail::plain(x), exponent = detail::plain(y);
  if (base == 0 && exponent != 0 && exponent < 1) return detail::without_slope(x, power);
  const T by_base = exponent == 0 ? T(0.0) : y.value * pow(x.value, y.value - T(1.0));
  if (constant_exponent || base == 0) {
    Dual<T, N> r = detail::chain(x, power, by_base);
    r.kink = r.kink || y.kink;
    return r;
  }
  return Dual<T, N>::linear(x, by_base, y, power * log(x.value), power);
}

/// Absolute value.
template <class T, int N>
Dual<T, N> abs(const Dual<T, N>& x) {
  if (detail::plain(x) == 0) return detail::without_slope(x, abs(x.value));
  return detail::plain(x) < 0 ? -x : x;
}
/// `a` where the condition holds, else `b`.
template <class T, int N>
Dual<T, N> select(const DualMask& condition, const Dual<T, N>& a, const std::type_identity_t<Dual<T, N>>& b) {
  Dual<T, N> r = condition.value ? a : b;
  r.kink = r.kink || (condition.kink && !detail::identical(a, b));
  return r;
}
/// The smaller value; of equal ones `b`.
template <class T, int N>
Dual<T, N> min(const Dual<T, N>& a, const std::type_identity_t<Dual<T, N>>& b) {
  return select(a < b, a, b);
}
/// The larger value; of equal ones `b`.
template <class T, int N>
Dual<T, N> max(const Dual<T, N>& a, const std::type_identity_t<Dual<T, N>>& b) {
  return select(a > b, a, b);
}
/// -1, 0 or 1.
template <class T, int N>
Dual<T, N> sign(const Dual<T, N>& x) {
  return detail::step_function(x, sign(detail::plain(x)), detail::plain(x) == 0);
}
/// Rounds to the nearest integer, ties to even.
template <class T, int N>
Dual<T, N> round(const Dual<T, N>& x) {
  const double value = detail::plain(x);
  return detail::step_function(x, round(value), value - floor(value) == 0.5);
}
/// The largest integer that is not above x.
template <class T, int N>
Dual<T, N> floor(const Dual<T, N>& x) {
  const double value = detail::plain(x);
  return detail::step_function(x, floor(value), floor(value) == value);
}
/// The smallest integer that is not below x.
template <class T, int N>
Dual<T, N> ceil(const Dual<T, N>& x) {
  return -floor(-x);
}
/// The remainder of x / y with the sign of x.
template <class T, int N>
Dual<T, N> fmod(const Dual<T, N>& x, const std::type_identity_t<Dual<T, N>>& y) {
  const double remainder = fmod(detail::plain(x), detail::plain(y));
  const double quotient = round((detail::plain(x) - remainder) / detail::plain(y));
  Dual<T, N> r = x - Dual<T, N>(quotient) * y;
  r.kink = r.kink || (remainder == 0 && quotient != 0);
  return r;
}
/// `magnitude` with the sign of `sign`.
template <class T, int N>
Dual<T, N> copysign(const Dual<T, N>& magnitude, const std::type_identity_t<Dual<T, N>>& sign) {
  const Dual<T, N> size = abs(magnitude);
  Dual<T, N> r = copysign(1.0, detail::plain(sign)) < 0 ? -size : size;
  r.kink = r.kink || detail::step_function(sign, 0, detail::plain(sign) == 0).kink;
  return r;
}
/// a b + c.
template <class T, int N>
Dual<T, N> fma(const Dual<T, N>& a, const std::type_identity_t<Dual<T, N>>& b,
               const std::type_identity_t<Dual<T, N>>& c) {
  return a * b + c;
}
/// Whether the condition holds.
inline bool any(const DualMask& condition) {
  return condition.value;
}
/// Whether the condition holds.
inline bool all(const DualMask& condition) {
  return condition.value;
}

/// The cell at (x, y), m, whose values do not depend on the position within it: their derivatives are 0.
template <class T, int N>
CellValues<Dual<T, N>> look_up(const GridView<4>& grid, const Dual<T, N>& x, const Dual<T, N>& y) {
  const CellValues<double> cell = look_up(grid, detail::plain(x), detail::plain(y));
  return {cell.a, cell.b, cell.c, cell.d};
}
/// The value of the cell at a position; its derivatives are 0.
template <class T, int N>
Dual<T, N> look_up(const GridView<1>& grid, const Dual<T, N>& x, const Dual<T, N>& y) {
  return Dual<T, N>(look_up(grid, detail::plain(x), detail::plain(y)));
}

}  // namespace slalom
