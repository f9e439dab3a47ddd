#pragma once

#include <type_traits>

#include "slalom/core/dispatch.hpp"
#include "slalom/core/math.hpp"

namespace slalom::detail {

/// Takes the place of an instruction set for the reference kernels, which compute in `double`, one value at a
/// time.
struct Reference {};

/// The type that a kernel computes with: packs of float32, or `double`.
template <class Target>
struct PackFor {
  using type = Pack<Target>;
};
template <>
struct PackFor<Reference> {
  using type = double;
};
template <class Target>
using PackIn = typename PackFor<Target>::type;

/// Loads, stores and reductions of packs and of `double`.
template <class F>
struct Lanes {
  using Real = float;
  static constexpr int count = F::lanes;
  static SLALOM_INLINE F load(const float* from) { return F::load(from); }
  static SLALOM_INLINE void store(const F& value, float* to) { value.store(to); }
  static SLALOM_INLINE float sum(const F& value) {
    float total = 0;
    for (int i = 0; i < F::lanes; ++i) total += value.v[i];
    return total;
  }
  /// Pairwise sum: fewer roundings per value and a shorter chain of dependent additions.
  static SLALOM_INLINE float sum_by_halves(const F& value) {
    float part[F::lanes];
    value.store(part);
    for (int n = F::lanes / 2; n > 0; n /= 2)
      for (int i = 0; i < n; ++i) part[i] += part[i + n];
    return part[0];
  }
  static SLALOM_INLINE float least(const F& value) {
    float m = value.v[0];
    for (int i = 1; i < F::lanes; ++i) m = value.v[i] < m ? value.v[i] : m;
    return m;
  }
};
template <>
struct Lanes<double> {
  using Real = double;
  static constexpr int count = 1;
  static double load(const double* from) { return *from; }
  static void store(double value, double* to) { *to = value; }
  static double sum(double value) { return value; }
  static double sum_by_halves(double value) { return value; }
  static double least(double value) { return value; }
};
template <class F>
using RealOf = typename Lanes<F>::Real;
template <class Target>
using RealIn = RealOf<PackIn<Target>>;

}  // namespace slalom::detail
