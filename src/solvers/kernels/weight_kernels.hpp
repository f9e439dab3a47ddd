#pragma once

#include <cstring>
#include <limits>

#include "slalom/core/math.hpp"
#include "solvers/kernels/kernels.hpp"

/// The kernels' bodies. `F` is `double` or a pack of float32.
namespace slalom::detail::body {

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
  /// The same by halves: fewer roundings in a row, and less waiting.
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

template <class F>
SLALOM_INLINE void place(const Rows<RealOf<F>>& noise, const Rows<RealOf<F>>& samples,
                         const SamplingDistribution<RealOf<F>>& to, Range range) {
  using L = Lanes<F>;
  const int end = range.first + range.count;
  for (int r = 0; r < samples.rows; ++r) {
    const RealOf<F>* z = noise.row(r);
    RealOf<F>* v = samples.row(r);
    const F mean(to.mean[r]), deviation(to.deviation[r]), low(to.low[r]), high(to.high[r]);
    int k = range.first;
    for (; k < end && k + L::count <= to.zero_mean_from; k += L::count) {
      L::store(clamp(mean + deviation * L::load(z + k), low, high), v + k);
    }
    if (k < end && k < to.zero_mean_from) {  // the pack in which the share around zero begins
      RealOf<F> centre[L::count];
      for (int i = 0; i < L::count; ++i) centre[i] = k + i < to.zero_mean_from ? to.mean[r] : RealOf<F>(0);
      L::store(clamp(L::load(centre) + deviation * L::load(z + k), low, high), v + k);
      k += L::count;
    }
    for (; k < end; k += L::count) L::store(clamp(deviation * L::load(z + k), low, high), v + k);
  }
}

template <class F>
SLALOM_INLINE void add_linear(const Rows<RealOf<F>>& v, const RealOf<F>* coefficient, Range range,
                              RealOf<F>* totals) {
  using L = Lanes<F>;
  for (int k = range.first; k < range.first + range.count; k += L::count) {
    F term0(0.0f), term1(0.0f);
    int r = 0;
    for (; r + 1 < v.rows; r += 2) {
      term0 = term0 + F(coefficient[r]) * L::load(v.row(r) + k);
      term1 = term1 + F(coefficient[r + 1]) * L::load(v.row(r + 1) + k);
    }
    if (r < v.rows) term0 = term0 + F(coefficient[r]) * L::load(v.row(r) + k);
    L::store(L::load(totals + k) + (term0 + term1), totals + k);
  }
}

template <class F>
SLALOM_INLINE void add_squared_distance(const Rows<RealOf<F>>& v, const RealOf<F>* centre,
                                        const RealOf<F>* weight, Range range, RealOf<F>* totals) {
  using L = Lanes<F>;
  for (int k = range.first; k < range.first + range.count; k += L::count) {
    F term(0.0f);
    for (int r = 0; r < v.rows; ++r) {
      const F difference = L::load(v.row(r) + k) - F(centre[r]);
      term = term + F(weight[r]) * difference * difference;
    }
    L::store(L::load(totals + k) + term, totals + k);
  }
}

template <class F>
SLALOM_INLINE void make_finite(Range range, RealOf<F>* costs) {
  using L = Lanes<F>;
  const F largest(std::numeric_limits<RealOf<F>>::max()),
      infinite(std::numeric_limits<RealOf<F>>::infinity());
  for (int k = range.first; k < range.first + range.count; k += L::count) {
    const F cost = L::load(costs + k);
    L::store(select(abs(cost) <= largest, cost, infinite), costs + k);
  }
}

template <class F>
SLALOM_INLINE CostStatistics<RealOf<F>> finish(const Rows<RealOf<F>>& v, const RealOf<F>* linear, Range range,
                                               RealOf<F>* costs, RealOf<F>* totals) {
  using L = Lanes<F>;
  using Real = RealOf<F>;
  const F largest(std::numeric_limits<Real>::max()), infinite(std::numeric_limits<Real>::infinity());
  const F zero(0.0f), one(1.0f);
  F least_cost = infinite, least_total = infinite, finite = zero;
  for (int k = range.first; k < range.first + range.count; k += L::count) {
    const F given = L::load(costs + k);
    const F cost = select(abs(given) <= largest, given, infinite);
    L::store(cost, costs + k);
    F total = cost;
    if (linear) {
      F term0 = zero, term1 = zero;
      int r = 0;
      for (; r + 1 < v.rows; r += 2) {
        term0 = term0 + F(linear[r]) * L::load(v.row(r) + k);
        term1 = term1 + F(linear[r + 1]) * L::load(v.row(r + 1) + k);
      }
      if (r < v.rows) term0 = term0 + F(linear[r]) * L::load(v.row(r) + k);
      total = cost + (term0 + term1);
      total = select(abs(total) <= largest, total, infinite);
    }
    L::store(total, totals + k);
    least_cost = min(least_cost, cost);
    least_total = min(least_total, total);
    finite = finite + select(total < infinite, one, zero);
  }
  return {L::least(least_cost), L::least(least_total), static_cast<int>(L::sum(finite))};
}

template <class F>
SLALOM_INLINE RealOf<F> minimum(const RealOf<F>* costs, Range range) {
  using L = Lanes<F>;
  F least(std::numeric_limits<RealOf<F>>::infinity());
  for (int k = range.first; k < range.first + range.count; k += L::count)
    least = min(least, L::load(costs + k));
  return L::least(least);
}

template <class F>
SLALOM_INLINE WeightSums<RealOf<F>> exponential_weights(const RealOf<F>* totals, const RealOf<F>* costs,
                                                        RealOf<F> least, RealOf<F> temperature, Range range,
                                                        RealOf<F>* weights) {
  using L = Lanes<F>;
  const F minimum_cost(least), inverse(RealOf<F>(1) / temperature), zero(0.0f);
  F weight(0.0f), squared(0.0f), cost(0.0f);
  for (int k = range.first; k < range.first + range.count; k += L::count) {
    const F w = exp((minimum_cost - L::load(totals + k)) * inverse);
    L::store(w, weights + k);
    weight = weight + w;
    squared = squared + w * w;
    cost = cost + select(w > zero, w * L::load(costs + k), zero);
  }
  return {L::sum(weight), L::sum(squared), L::sum(cost)};
}

/// e_q(-x) = [1 - (1 - q) x]_+^(1 / (1 - q)) with x = (total - least) / temperature. The power is taken as
/// exp(log1p(-(1 - q) x) / (1 - q)); y log(1 + y) / ((1 + y) - 1) is log1p(y) without its loss at small y
/// (Kahan), so that q near 1 is as good as any.
template <class F>
SLALOM_INLINE WeightSums<RealOf<F>> tsallis_weights(const RealOf<F>* totals, const RealOf<F>* costs,
                                                    RealOf<F> least, RealOf<F> temperature, RealOf<F> index,
                                                    Range range, RealOf<F>* weights) {
  using L = Lanes<F>;
  using Real = RealOf<F>;
  const F minimum_cost(least), inverse(Real(1) / temperature), zero(0.0f), one(1.0f);
  const F deformation(Real(1) - index), power(Real(1) / (Real(1) - index));
  const F infinite(std::numeric_limits<Real>::infinity());
  F weight(0.0f), squared(0.0f), cost(0.0f);
  for (int k = range.first; k < range.first + range.count; k += L::count) {
    const F total = L::load(totals + k);
    const F y = deformation * ((minimum_cost - total) * inverse);
    const F u = one + y;
    const F gone = u - one;
    const F logarithm = select(abs(gone) > zero, log(u) * (y / gone), y);
    const F w = select((u > zero) & (total < infinite), exp(logarithm * power), zero);
    L::store(w, weights + k);
    weight = weight + w;
    squared = squared + w * w;
    cost = cost + select(w > zero, w * L::load(costs + k), zero);
  }
  return {L::sum(weight), L::sum(squared), L::sum(cost)};
}

template <class F>
SLALOM_INLINE void add_scaled(const RealOf<F>* costs, RealOf<F> factor, const RealOf<F>* terms, Range range,
                              RealOf<F>* totals) {
  using L = Lanes<F>;
  const F f(factor);
  for (int k = range.first; k < range.first + range.count; k += L::count) {
    L::store(L::load(costs + k) + f * L::load(terms + k), totals + k);
  }
}

template <class F>
SLALOM_INLINE void scale(RealOf<F> factor, Range range, RealOf<F>* values) {
  using L = Lanes<F>;
  const F f(factor);
  for (int k = range.first; k < range.first + range.count; k += L::count) {
    L::store(L::load(values + k) * f, values + k);
  }
}

/// Four running sums a row, so that additions need not wait for each other.
template <bool squares, class F>
SLALOM_INLINE void weighted_powers(const Rows<RealOf<F>>& v, const RealOf<F>* weights,
                                   const RealOf<F>* centre, Range range, RealOf<F>* sums) {
  using L = Lanes<F>;
  constexpr int step = 4 * L::count;
  const int end = range.first + range.count;
  for (int r = 0; r < v.rows; ++r) {
    const RealOf<F>* values = v.row(r);
    const F middle(centre[r]);
    F s0(0.0f), s1(0.0f), s2(0.0f), s3(0.0f);
    const auto term = [&](int k) {
      const F difference = L::load(values + k) - middle;
      const F weighted = L::load(weights + k) * difference;
      if constexpr (squares) {
        return F(weighted * difference);
      } else {
        return weighted;
      }
    };
    int k = range.first;
    for (; k + step <= end; k += step) {
      s0 = s0 + term(k);
      s1 = s1 + term(k + L::count);
      s2 = s2 + term(k + 2 * L::count);
      s3 = s3 + term(k + 3 * L::count);
    }
    for (; k < end; k += L::count) s0 = s0 + term(k);
    sums[r] = L::sum((s0 + s1) + (s2 + s3));
  }
}

template <class F>
SLALOM_INLINE void gather(const Rows<RealOf<F>>& from, const int* indices, Range range,
                          const Rows<RealOf<F>>& to) {
  using Target = typename F::Target;
  for (int k = range.first; k < range.first + range.count; k += F::lanes) {
    simd::IntPack<Target> index;
    std::memcpy(&index.v, indices + k, sizeof index.v);
    for (int r = 0; r < from.rows; ++r) {
      F taken;
      simd::Operations<Target>::gather(from.row(r), index.v, taken.v);
      taken.store(to.row(r) + k);
    }
  }
}

template <class F>
SLALOM_INLINE void two_moments(const Rows<RealOf<F>>& v, const RealOf<F>* first, const RealOf<F>* second,
                               const RealOf<F>* centre, Range range, RealOf<F>* sums) {
  using L = Lanes<F>;
  for (int r = 0; r < v.rows; ++r) {
    const RealOf<F>* values = v.row(r);
    const F middle(centre[r]);
    F sum0(0.0f), square0(0.0f), sum1(0.0f), square1(0.0f);
    for (int k = range.first; k < range.first + range.count; k += L::count) {
      const F value = L::load(values + k), w0 = L::load(first + k), w1 = L::load(second + k);
      const F difference = value - middle;
      const F distance = difference * difference;
      sum0 = sum0 + w0 * value;
      square0 = square0 + w0 * distance;
      sum1 = sum1 + w1 * value;
      square1 = square1 + w1 * distance;
    }
    RealOf<F>* to = sums + moments * r;
    to[0] = L::sum_by_halves(sum0);
    to[1] = L::sum_by_halves(square0);
    to[2] = L::sum_by_halves(sum1);
    to[3] = L::sum_by_halves(square1);
  }
}

template <class F>
SLALOM_INLINE WeightSums<RealOf<F>> split_weights(RealOf<F> falling, RealOf<F> growing, Range range,
                                                  RealOf<F>* evaluated, RealOf<F>* rejected) {
  using L = Lanes<F>;
  const F down(RealOf<F>(1) / falling), up(RealOf<F>(1) / growing), zero(0.0f);
  F positive(0.0f), negative(0.0f);
  for (int k = range.first; k < range.first + range.count; k += L::count) {
    const F difference = L::load(evaluated + k) * down - L::load(rejected + k) * up;
    const F good = max(difference, zero), bad = max(-difference, zero);
    L::store(good, evaluated + k);
    L::store(bad, rejected + k);
    positive = positive + good;
    negative = negative + bad;
  }
  return {L::sum_by_halves(positive), L::sum_by_halves(negative), 0};
}

}  // namespace slalom::detail::body
