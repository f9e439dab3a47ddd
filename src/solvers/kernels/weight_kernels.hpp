#pragma once

#include <cstring>
#include <limits>

#include "solvers/kernels/kernels.hpp"
#include "solvers/kernels/lanes.hpp"

/// Kernels that make samples, compute weights and average. `Kernels` documents each.
namespace slalom::detail::kernel {

struct Sample {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows<RealIn<Target>>& noise, const Rows<RealIn<Target>>& samples,
                                const SamplingDistribution<RealIn<Target>>& to, Range range) {
    using F = PackIn<Target>;
    using L = Lanes<F>;
    using Real = RealIn<Target>;
    const int end = range.first + range.count;
    for (int r = 0; r < samples.rows; ++r) {
      const Real* z = noise.row(r);
      Real* v = samples.row(r);
      const F mean(to.mean[r]), deviation(to.deviation[r]), low(to.low[r]), high(to.high[r]);
      int k = range.first;
      for (; k < end && k + L::count <= to.zero_mean_from; k += L::count) {
        L::store(clamp(mean + deviation * L::load(z + k), low, high), v + k);
      }
      if (k < end && k < to.zero_mean_from) {  // the pack that contains the first sample around zero
        Real centre[L::count];
        for (int i = 0; i < L::count; ++i) centre[i] = k + i < to.zero_mean_from ? to.mean[r] : Real(0);
        L::store(clamp(L::load(centre) + deviation * L::load(z + k), low, high), v + k);
        k += L::count;
      }
      for (; k < end; k += L::count) L::store(clamp(deviation * L::load(z + k), low, high), v + k);
    }
  }
};

struct AddLinear {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows<RealIn<Target>>& v, const RealIn<Target>* coefficient, Range range,
                                RealIn<Target>* totals) {
    using F = PackIn<Target>;
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
};

struct AddSquaredDistance {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows<RealIn<Target>>& v, const RealIn<Target>* centre,
                                const RealIn<Target>* weight, Range range, RealIn<Target>* totals) {
    using F = PackIn<Target>;
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
};

struct MakeFinite {
  template <class Target>
  SLALOM_KERNEL static void run(Range range, RealIn<Target>* costs) {
    using F = PackIn<Target>;
    using L = Lanes<F>;
    using Real = RealIn<Target>;
    const F largest(std::numeric_limits<Real>::max()), infinite(std::numeric_limits<Real>::infinity());
    for (int k = range.first; k < range.first + range.count; k += L::count) {
      const F cost = L::load(costs + k);
      L::store(select(abs(cost) <= largest, cost, infinite), costs + k);
    }
  }
};

struct Finish {
  template <class Target>
  SLALOM_KERNEL static CostStatistics<RealIn<Target>> run(const Rows<RealIn<Target>>& v,
                                                          const RealIn<Target>* linear, Range range,
                                                          RealIn<Target>* costs, RealIn<Target>* totals) {
    using F = PackIn<Target>;
    using L = Lanes<F>;
    using Real = RealIn<Target>;
    const F largest(std::numeric_limits<Real>::max()), infinite(std::numeric_limits<Real>::infinity());
    const F zero(0.0f), one(1.0f);
    F min_cost = infinite, min_total = infinite, finite = zero;
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
      min_cost = min(min_cost, cost);
      min_total = min(min_total, total);
      finite = finite + select(total < infinite, one, zero);
    }
    return {L::least(min_cost), L::least(min_total), static_cast<int>(L::sum(finite))};
  }
};

struct Minimum {
  template <class Target>
  SLALOM_KERNEL static RealIn<Target> run(const RealIn<Target>* costs, Range range) {
    using F = PackIn<Target>;
    using L = Lanes<F>;
    using Real = RealIn<Target>;
    F least(std::numeric_limits<Real>::infinity());
    for (int k = range.first; k < range.first + range.count; k += L::count)
      least = min(least, L::load(costs + k));
    return L::least(least);
  }
};

struct ExponentialWeights {
  template <class Target>
  SLALOM_KERNEL static WeightSums<RealIn<Target>> run(const RealIn<Target>* totals,
                                                      const RealIn<Target>* costs, RealIn<Target> least,
                                                      RealIn<Target> temperature, Range range,
                                                      RealIn<Target>* weights) {
    using F = PackIn<Target>;
    using L = Lanes<F>;
    using Real = RealIn<Target>;
    const F minimum_cost(least), inverse(Real(1) / temperature), zero(0.0f);
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
};

/// e_q(-x) = [1 - (1 - q) x]_+^(1 / (1 - q)) with x = (total - least) / temperature. The power is computed as
/// exp(log1p(-(1 - q) x) / (1 - q)), where log1p(y) = y log(1 + y) / ((1 + y) - 1) is exact for small y
/// (Kahan), so that the result is accurate for q near 1.
struct TsallisWeights {
  template <class Target>
  SLALOM_KERNEL static WeightSums<RealIn<Target>> run(const RealIn<Target>* totals,
                                                      const RealIn<Target>* costs, RealIn<Target> least,
                                                      RealIn<Target> temperature, RealIn<Target> index,
                                                      Range range, RealIn<Target>* weights) {
    using F = PackIn<Target>;
    using L = Lanes<F>;
    using Real = RealIn<Target>;
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
};

struct AddScaled {
  template <class Target>
  SLALOM_KERNEL static void run(const RealIn<Target>* costs, RealIn<Target> factor,
                                const RealIn<Target>* terms, Range range, RealIn<Target>* totals) {
    using F = PackIn<Target>;
    using L = Lanes<F>;
    const F f(factor);
    for (int k = range.first; k < range.first + range.count; k += L::count) {
      L::store(L::load(costs + k) + f * L::load(terms + k), totals + k);
    }
  }
};

struct Scale {
  template <class Target>
  SLALOM_KERNEL static void run(RealIn<Target> factor, Range range, RealIn<Target>* values) {
    using F = PackIn<Target>;
    using L = Lanes<F>;
    const F f(factor);
    for (int k = range.first; k < range.first + range.count; k += L::count) {
      L::store(L::load(values + k) * f, values + k);
    }
  }
};

/// Uses four running sums per row, so that additions do not depend on each other.
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

struct WeightedSums {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows<RealIn<Target>>& v, const RealIn<Target>* weights,
                                const RealIn<Target>* centre, Range range, RealIn<Target>* sums) {
    weighted_powers<false, PackIn<Target>>(v, weights, centre, range, sums);
  }
};

struct WeightedSquares {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows<RealIn<Target>>& v, const RealIn<Target>* weights,
                                const RealIn<Target>* centre, Range range, RealIn<Target>* sums) {
    weighted_powers<true, PackIn<Target>>(v, weights, centre, range, sums);
  }
};

struct Gather {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows<RealIn<Target>>& from, const int* indices, Range range,
                                const Rows<RealIn<Target>>& to) {
    using F = PackIn<Target>;
    for (int k = range.first; k < range.first + range.count; k += Lanes<F>::count) {
      if constexpr (is_pack<F>) {
        simd::IntPack<Target> index;
        std::memcpy(&index.v, indices + k, sizeof index.v);
        for (int r = 0; r < from.rows; ++r) {
          F gathered;
          simd::Operations<Target>::gather(from.row(r), index.v, gathered.v);
          gathered.store(to.row(r) + k);
        }
      } else {
        for (int r = 0; r < from.rows; ++r) to.row(r)[k] = from.row(r)[indices[k]];
      }
    }
  }
};

struct TwoMoments {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows<RealIn<Target>>& v, const RealIn<Target>* first,
                                const RealIn<Target>* second, const RealIn<Target>* centre, Range range,
                                RealIn<Target>* sums) {
    using F = PackIn<Target>;
    using L = Lanes<F>;
    using Real = RealIn<Target>;
    for (int r = 0; r < v.rows; ++r) {
      const Real* values = v.row(r);
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
      Real* to = sums + moments * r;
      to[0] = L::sum_by_halves(sum0);
      to[1] = L::sum_by_halves(square0);
      to[2] = L::sum_by_halves(sum1);
      to[3] = L::sum_by_halves(square1);
    }
  }
};

struct SplitWeights {
  template <class Target>
  SLALOM_KERNEL static WeightSums<RealIn<Target>> run(RealIn<Target> falling, RealIn<Target> growing,
                                                      Range range, RealIn<Target>* evaluated,
                                                      RealIn<Target>* rejected) {
    using F = PackIn<Target>;
    using L = Lanes<F>;
    using Real = RealIn<Target>;
    const F down(Real(1) / falling), up(Real(1) / growing), zero(0.0f);
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
};

}  // namespace slalom::detail::kernel
