#include "solvers/kernels/kernels.hpp"

#include <limits>

#include "slalom/core/dispatch.hpp"
#include "slalom/core/math.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::detail::kernels {

namespace {

template <class F>
SLALOM_INLINE float sum_of(const F& value) {
  float total = 0;
  for (int i = 0; i < F::lanes; ++i) total += value.v[i];
  return total;
}

template <class F>
SLALOM_INLINE float least_of(const F& value) {
  float m = value.v[0];
  for (int i = 1; i < F::lanes; ++i) m = value.v[i] < m ? value.v[i] : m;
  return m;
}

struct Sample {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows& noise, const Rows& samples, const SamplingDistribution& to,
                                Range range) {
    using F = Pack<Target>;
    const int end = range.first + range.count;
    for (int r = 0; r < samples.rows; ++r) {
      const float* z = noise.row(r);
      float* v = samples.row(r);
      const F mean(to.mean[r]), deviation(to.deviation[r]), low(to.low[r]), high(to.high[r]);
      int k = range.first;
      for (; k < end && k + F::lanes <= to.zero_mean_from; k += F::lanes) {
        clamp(mean + deviation * F::load(z + k), low, high).store(v + k);
      }
      if (k < end && k < to.zero_mean_from) {  // the pack that contains the first sample around zero
        float centre[F::lanes];
        for (int i = 0; i < F::lanes; ++i) centre[i] = k + i < to.zero_mean_from ? to.mean[r] : 0.0f;
        clamp(F::load(centre) + deviation * F::load(z + k), low, high).store(v + k);
        k += F::lanes;
      }
      for (; k < end; k += F::lanes) clamp(deviation * F::load(z + k), low, high).store(v + k);
    }
  }
};

struct SampleMixture {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows& white, const Rows& shaped, const Rows& samples,
                                const Mixture& from, Range range) {
    using F = Pack<Target>;
    const int sources = static_cast<int>(from.sources.size());
    for (int r = 0; r < samples.rows; ++r) {
      const F low(from.low[r]), high(from.high[r]);
      for (int k = range.first; k < range.first + range.count; k += F::lanes) {
        const F source = F::load(from.source + k);
        F mean(from.sources[0].mean[r]), deviation(from.sources[0].deviation[r]);
        for (int s = 1; s < sources; ++s) {
          const auto here = source == F(s);
          mean = select(here, F(from.sources[s].mean[r]), mean);
          deviation = select(here, F(from.sources[s].deviation[r]), deviation);
        }
        const F z =
            select(F::load(from.white + k) > F(0.0f), F::load(white.row(r) + k), F::load(shaped.row(r) + k));
        clamp(mean + deviation * F::load(from.scale + k) * z, low, high).store(samples.row(r) + k);
      }
    }
  }
};

/// Computes `Colour` for `packs` packs that begin at sample k. They share each loaded entry of L.
template <int packs, class F>
SLALOM_INLINE void colour_packs(const Rows& z, const float* factor, int first, int step, int k) {
  const int steps = (z.rows - first + step - 1) / step;
  for (int t = steps - 1; t >= 0; --t) {
    const float* row = factor + static_cast<std::ptrdiff_t>(t) * (t + 1) / 2;
    F sum[packs];
    for (int b = 0; b < packs; ++b) sum[b] = F(0.0f);
    for (int s = 0; s <= t; ++s) {
      const F entry(row[s]);
      const float* from = z.row(first + s * step) + k;
      for (int b = 0; b < packs; ++b) sum[b] = sum[b] + entry * F::load(from + b * F::lanes);
    }
    for (int b = 0; b < packs; ++b) sum[b].store(z.row(first + t * step) + k + b * F::lanes);
  }
}

/// From the last row to the first, in place.
struct Colour {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows& z, const float* factor, int first, int step, Range range) {
    using F = Pack<Target>;
    constexpr int lanes = F::lanes;
    const int end = range.first + range.count;
    int k = range.first;
    for (; k + 4 * lanes <= end; k += 4 * lanes) colour_packs<4, F>(z, factor, first, step, k);
    for (; k < end; k += lanes) colour_packs<1, F>(z, factor, first, step, k);
  }
};

/// The sum over rows of coefficient[row] v[row][k], for a pack of samples. Adds up even and odd rows
/// separately, so that the two sums do not wait for each other.
template <class F>
SLALOM_INLINE F linear_term(const Rows& v, const float* coefficient, int k) {
  F term0(0.0f), term1(0.0f);
  int r = 0;
  for (; r + 1 < v.rows; r += 2) {
    term0 = term0 + F(coefficient[r]) * F::load(v.row(r) + k);
    term1 = term1 + F(coefficient[r + 1]) * F::load(v.row(r + 1) + k);
  }
  if (r < v.rows) term0 = term0 + F(coefficient[r]) * F::load(v.row(r) + k);
  return term0 + term1;
}

struct AddLinear {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows& v, const float* coefficient, Range range, float* totals) {
    using F = Pack<Target>;
    for (int k = range.first; k < range.first + range.count; k += F::lanes)
      (F::load(totals + k) + linear_term<F>(v, coefficient, k)).store(totals + k);
  }
};

struct AddSquaredDistance {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows& v, const float* centre, const float* weight, Range range,
                                float* totals) {
    using F = Pack<Target>;
    for (int k = range.first; k < range.first + range.count; k += F::lanes) {
      F term(0.0f);
      for (int r = 0; r < v.rows; ++r) {
        const F difference = F::load(v.row(r) + k) - F(centre[r]);
        term = term + F(weight[r]) * difference * difference;
      }
      (F::load(totals + k) + term).store(totals + k);
    }
  }
};

struct AddScaled {
  template <class Target>
  SLALOM_KERNEL static void run(const float* costs, float factor, const float* terms, Range range,
                                float* totals) {
    using F = Pack<Target>;
    const F f(factor);
    for (int k = range.first; k < range.first + range.count; k += F::lanes) {
      (F::load(costs + k) + f * F::load(terms + k)).store(totals + k);
    }
  }
};

struct MakeFinite {
  template <class Target>
  SLALOM_KERNEL static void run(Range range, float* costs) {
    using F = Pack<Target>;
    const F largest(std::numeric_limits<float>::max()), infinite(std::numeric_limits<float>::infinity());
    for (int k = range.first; k < range.first + range.count; k += F::lanes) {
      const F cost = F::load(costs + k);
      select(abs(cost) <= largest, cost, infinite).store(costs + k);
    }
  }
};

struct Finish {
  template <class Target>
  SLALOM_KERNEL static CostStatistics run(const Rows& v, const float* linear, Range range, float* costs,
                                          float* totals) {
    using F = Pack<Target>;
    const F largest(std::numeric_limits<float>::max()), infinite(std::numeric_limits<float>::infinity());
    const F zero(0.0f), one(1.0f);
    F min_cost = infinite, min_total = infinite, finite = zero;
    for (int k = range.first; k < range.first + range.count; k += F::lanes) {
      const F given = F::load(costs + k);
      const F cost = select(abs(given) <= largest, given, infinite);
      cost.store(costs + k);
      F total = cost;
      if (linear) {
        total = cost + linear_term<F>(v, linear, k);
        total = select(abs(total) <= largest, total, infinite);
      }
      total.store(totals + k);
      min_cost = min(min_cost, cost);
      min_total = min(min_total, total);
      finite = finite + select(total < infinite, one, zero);
    }
    return {least_of(min_cost), least_of(min_total), saturate_cast<int>(sum_of(finite))};
  }
};

struct Minimum {
  template <class Target>
  SLALOM_KERNEL static float run(const float* costs, Range range) {
    using F = Pack<Target>;
    F least(std::numeric_limits<float>::infinity());
    for (int k = range.first; k < range.first + range.count; k += F::lanes)
      least = min(least, F::load(costs + k));
    return least_of(least);
  }
};

struct ExponentialWeights {
  template <class Target>
  SLALOM_KERNEL static WeightSums<float> run(const float* totals, const float* costs, float least,
                                             float temperature, Range range, float* weights) {
    using F = Pack<Target>;
    const F minimum_cost(least), inverse(1.0f / temperature), zero(0.0f);
    F weight(0.0f), squared(0.0f), cost(0.0f);
    for (int k = range.first; k < range.first + range.count; k += F::lanes) {
      const F w = exp((minimum_cost - F::load(totals + k)) * inverse);
      w.store(weights + k);
      weight = weight + w;
      squared = squared + w * w;
      cost = cost + select(w > zero, w * F::load(costs + k), zero);
    }
    return {sum_of(weight), sum_of(squared), sum_of(cost)};
  }
};

struct Scale {
  template <class Target>
  SLALOM_KERNEL static void run(float factor, Range range, float* values) {
    using F = Pack<Target>;
    const F f(factor);
    for (int k = range.first; k < range.first + range.count; k += F::lanes) {
      (F::load(values + k) * f).store(values + k);
    }
  }
};

/// Uses four running sums, so that additions do not depend on each other.
template <bool squares>
struct WeightedPowers {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows& v, const float* weights, const float* centre, Range range,
                                float* sums) {
    using F = Pack<Target>;
    constexpr int step = 4 * F::lanes;
    const int end = range.first + range.count;
    for (int r = 0; r < v.rows; ++r) {
      const float* values = v.row(r);
      const F middle(centre[r]);
      F s0(0.0f), s1(0.0f), s2(0.0f), s3(0.0f);
      const auto term = [&](int k) {
        const F difference = F::load(values + k) - middle;
        const F weighted = F::load(weights + k) * difference;
        if constexpr (squares) {
          return F(weighted * difference);
        } else {
          return weighted;
        }
      };
      int k = range.first;
      for (; k + step <= end; k += step) {
        s0 = s0 + term(k);
        s1 = s1 + term(k + F::lanes);
        s2 = s2 + term(k + 2 * F::lanes);
        s3 = s3 + term(k + 3 * F::lanes);
      }
      for (; k < end; k += F::lanes) s0 = s0 + term(k);
      sums[r] = sum_of((s0 + s1) + (s2 + s3));
    }
  }
};

}  // namespace

void sample(const Rows& noise, const Rows& samples, const SamplingDistribution& to, Range range) {
  simd::dispatch<Sample>(noise, samples, to, range);
}

void sample_mixture(const Rows& white, const Rows& shaped, const Rows& samples, const Mixture& from,
                    Range range) {
  simd::dispatch<SampleMixture>(white, shaped, samples, from, range);
}

void colour(const Rows& z, const float* factor, int first, int step, Range range) {
  simd::dispatch<Colour>(z, factor, first, step, range);
}

void add_linear(const Rows& v, const float* coefficient, Range range, float* totals) {
  simd::dispatch<AddLinear>(v, coefficient, range, totals);
}

void add_squared_distance(const Rows& v, const float* centre, const float* weight, Range range,
                          float* totals) {
  simd::dispatch<AddSquaredDistance>(v, centre, weight, range, totals);
}

void add_scaled(const float* costs, float factor, const float* terms, Range range, float* totals) {
  simd::dispatch<AddScaled>(costs, factor, terms, range, totals);
}

void make_finite(Range range, float* costs) {
  simd::dispatch<MakeFinite>(range, costs);
}

CostStatistics finish(const Rows& v, const float* linear, Range range, float* costs, float* totals) {
  return simd::dispatch<Finish>(v, linear, range, costs, totals);
}

float minimum(const float* costs, Range range) {
  return simd::dispatch<Minimum>(costs, range);
}

WeightSums<float> exponential_weights(const float* totals, const float* costs, float least, float temperature,
                                      Range range, float* weights) {
  return simd::dispatch<ExponentialWeights>(totals, costs, least, temperature, range, weights);
}

void scale(float factor, Range range, float* values) {
  simd::dispatch<Scale>(factor, range, values);
}

void weighted_sums(const Rows& v, const float* weights, const float* centre, Range range, float* sums) {
  simd::dispatch<WeightedPowers<false>>(v, weights, centre, range, sums);
}

void weighted_squares(const Rows& v, const float* weights, const float* centre, Range range, float* sums) {
  simd::dispatch<WeightedPowers<true>>(v, weights, centre, range, sums);
}

}  // namespace slalom::detail::kernels
