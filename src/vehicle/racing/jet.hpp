#pragma once

#include <array>
#include <cmath>

namespace slalom::vehicle::detail {

/// A value with its first and second derivatives with respect to N variables (forward differentiation).
template <int N>
struct Jet {
  static constexpr int pairs = N * (N + 1) / 2;

  double value = 0;
  std::array<double, N> gradient{};
  std::array<double, pairs> hessian{};  ///< lower triangle, row by row

  Jet() = default;
  Jet(double constant) : value(constant) {}  // NOLINT(google-explicit-constructor): mixes with constants
  /// The variable of this index.
  static Jet variable(double value, int index, double scale = 1) {
    Jet jet(value);
    jet.gradient[static_cast<std::size_t>(index)] = scale;
    return jet;
  }
};

/// f(x) from the value and the two derivatives of f.
template <int N>
Jet<N> chain(const Jet<N>& x, double f, double first, double second) {
  Jet<N> result(f);
  for (int i = 0, k = 0; i < N; ++i) {
    const double slope = second * x.gradient[i];
    result.gradient[i] = first * x.gradient[i];
    for (int j = 0; j <= i; ++j, ++k) result.hessian[k] = first * x.hessian[k] + slope * x.gradient[j];
  }
  return result;
}

template <int N>
Jet<N> operator+(Jet<N> a, const Jet<N>& b) {
  a.value += b.value;
  for (int i = 0; i < N; ++i) a.gradient[i] += b.gradient[i];
  for (int k = 0; k < Jet<N>::pairs; ++k) a.hessian[k] += b.hessian[k];
  return a;
}

template <int N>
Jet<N> operator*(double s, Jet<N> a) {
  a.value *= s;
  for (double& g : a.gradient) g *= s;
  for (double& h : a.hessian) h *= s;
  return a;
}

template <int N>
Jet<N> operator+(double s, Jet<N> a) {
  a.value += s;
  return a;
}

template <int N>
Jet<N> operator-(const Jet<N>& a, const Jet<N>& b) {
  return a + (-1.0 * b);
}

template <int N>
Jet<N> operator-(double s, const Jet<N>& a) {
  return s + (-1.0 * a);
}

template <int N>
Jet<N> operator*(const Jet<N>& a, const Jet<N>& b) {
  Jet<N> result(a.value * b.value);
  for (int i = 0, k = 0; i < N; ++i) {
    result.gradient[i] = a.gradient[i] * b.value + a.value * b.gradient[i];
    for (int j = 0; j <= i; ++j, ++k)
      result.hessian[k] = a.hessian[k] * b.value + a.value * b.hessian[k] + a.gradient[i] * b.gradient[j] +
                          a.gradient[j] * b.gradient[i];
  }
  return result;
}

template <int N>
Jet<N> reciprocal(const Jet<N>& x) {
  const double r = 1 / x.value;
  return chain(x, r, -r * r, 2 * r * r * r);
}

template <int N>
Jet<N> square_root(const Jet<N>& x) {
  const double root = std::sqrt(x.value);
  return chain(x, root, 0.5 / root, -0.25 / (root * x.value));
}

template <int N>
Jet<N> logarithm(const Jet<N>& x) {
  const double r = 1 / x.value;
  return chain(x, std::log(x.value), r, -r * r);
}

template <int N>
double value_of(const Jet<N>& x) {
  return x.value;
}

// The same names for plain numbers, so that one template computes values alone or with derivatives.
inline double reciprocal(double x) {
  return 1 / x;
}
inline double square_root(double x) {
  return std::sqrt(x);
}
inline double logarithm(double x) {
  return std::log(x);
}
inline double value_of(double x) {
  return x;
}

}  // namespace slalom::vehicle::detail
