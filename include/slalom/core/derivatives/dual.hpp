#pragma once

#include "slalom/core/simd.hpp"

/// Dual numbers: a scalar type for problems that carries exact derivatives along (forward-mode automatic
/// differentiation). `linearize` (linearize.hpp) runs a problem's functions over them. Their mathematics is
/// in dual_math.hpp.
namespace slalom {

/// The truth value of a comparison of dual numbers. `kink` says that the operands were equal and their
/// derivatives not, so that the comparison changes within any distance.
struct DualMask {
  bool value = false;  ///< result of the comparison
  bool kink = false;   ///< whether it changes here

  DualMask() = default;
  /// A truth value that does not change here.
  DualMask(bool truth, bool changes = false) : value(truth), kink(changes) {}
  /// The truth value.
  explicit operator bool() const { return value; }

  friend DualMask operator&(DualMask a, DualMask b) { return {a.value && b.value, a.kink || b.kink}; }
  friend DualMask operator|(DualMask a, DualMask b) { return {a.value || b.value, a.kink || b.kink}; }
  friend DualMask operator&&(DualMask a, DualMask b) { return a & b; }
  friend DualMask operator||(DualMask a, DualMask b) { return a | b; }
  friend DualMask operator!(DualMask a) { return {!a.value, a.kink}; }
};

template <class T, int N>
struct Dual;

namespace detail {

/// The number without its derivatives.
inline double plain(double x) {
  return x;
}
template <class T, int N>
double plain(const Dual<T, N>& x) {
  return plain(x.value);
}
/// Whether two numbers have the same value and the same derivatives.
inline bool identical(double a, double b) {
  return a == b;
}
template <class T, int N>
bool identical(const Dual<T, N>& a, const Dual<T, N>& b) {
  bool same = identical(a.value, b.value);
  for (int i = 0; i < N; ++i) same = same && identical(a.derivative[i], b.derivative[i]);
  return same;
}
/// Whether a function on the way to a number has no derivative where it was evaluated.
inline bool has_kink(double) {
  return false;
}
template <class T, int N>
bool has_kink(const Dual<T, N>& x) {
  return x.kink || has_kink(x.value);
}

}  // namespace detail

/// A number with its derivatives in `N` directions. `T` is double, or itself dual for second derivatives.
///
/// Where a function has no derivative or an infinite one (`abs` at 0, `min` of equal values, `sqrt` at 0,
/// `floor` at an integer, a condition of `select` that changes), the value is that of the function, the
/// derivative is that of the branch that the double code takes, or 0 if it takes none, and `kink` is set, in
/// this number and in all that are computed from it. Jumps do not show in derivatives: that of
/// `select(hit, T(100), T(0))` is 0.
template <class T, int N>
struct Dual {
  T value;            ///< value of the number
  T derivative[N];    ///< derivative in each direction
  bool kink = false;  ///< whether a function on the way here has no derivative where it was evaluated

  Dual() = default;
  /// A constant.
  Dual(double constant) : value(constant) {
    for (T& d : derivative) d = T(0.0);
  }
  /// A constant.
  explicit Dual(const Coefficient& constant) : Dual(static_cast<double>(constant)) {}
  /// A constant.
  explicit Dual(const T& constant) requires(!std::same_as<T, double>) : Dual(0.0) { value = constant; }

  friend Dual operator+(const Dual& a, const Dual& b) {
    return linear(a, T(1.0), b, T(1.0), a.value + b.value);
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    return linear(a, T(1.0), b, T(-1.0), a.value - b.value);
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return linear(a, b.value, b, a.value, a.value * b.value);
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const T quotient = a.value / b.value, inverse = T(1.0) / b.value;
    return linear(a, inverse, b, -quotient * inverse, quotient);
  }
  friend Dual operator-(const Dual& a) { return Dual(0.0) - a; }
  Dual& operator+=(const Dual& b) { return *this = *this + b; }
  Dual& operator-=(const Dual& b) { return *this = *this - b; }
  Dual& operator*=(const Dual& b) { return *this = *this * b; }
  Dual& operator/=(const Dual& b) { return *this = *this / b; }

  friend DualMask operator<(const Dual& a, const Dual& b) {
    return compare(a, b, detail::plain(a) < detail::plain(b));
  }
  friend DualMask operator<=(const Dual& a, const Dual& b) {
    return compare(a, b, detail::plain(a) <= detail::plain(b));
  }
  friend DualMask operator>(const Dual& a, const Dual& b) { return b < a; }
  friend DualMask operator>=(const Dual& a, const Dual& b) { return b <= a; }
  friend DualMask operator==(const Dual& a, const Dual& b) {
    return compare(a, b, detail::plain(a) == detail::plain(b));
  }
  friend DualMask operator!=(const Dual& a, const Dual& b) { return !(a == b); }

  /// A number of this `value` whose derivatives are `by_a` times those of a plus `by_b` times those of b.
  static Dual linear(const Dual& a, const T& by_a, const Dual& b, const T& by_b, const T& value) {
    Dual r;
    r.value = value;
    for (int i = 0; i < N; ++i) r.derivative[i] = by_a * a.derivative[i] + by_b * b.derivative[i];
    r.kink = a.kink || b.kink;
    return r;
  }

 private:
  static DualMask compare(const Dual& a, const Dual& b, bool holds) {
    const bool equal = detail::plain(a) == detail::plain(b);
    return {holds, a.kink || b.kink || (equal && !detail::identical(a, b))};
  }
};

}  // namespace slalom
