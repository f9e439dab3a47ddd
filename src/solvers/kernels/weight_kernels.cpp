#include "solvers/kernels/kernels.hpp"

#include <limits>

#include "slalom/core/dispatch.hpp"
#include "slalom/core/math.hpp"

namespace slalom::detail::kernels {

namespace {

template <class F>
SLALOM_INLINE float sum_of(const F& value) {
  float total = 0;
  for (int i = 0; i < F::lanes; ++i) total += value.v[i];
  return total;
}

/// Sums the lanes in pairs, which has fewer roundings per value and a shorter chain of dependent additions.
template <class F>
SLALOM_INLINE float sum_by_halves(const F& value) {
  float part[F::lanes];
  value.store(part);
  for (int n = F::lanes / 2; n > 0; n /= 2)
    for (int i = 0; i < n; ++i) part[i] += part[i + n];
  return part[0];
}

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

/// Uses four running sums per row, so that additions do not depend on each other.
template <bool squares, class F>
SLALOM_INLINE void weighted_powers(const Rows& v, const float* weights, const float* centre, Range range,
                                   float* sums) {
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

struct WeightedSums {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows& v, const float* weights, const float* centre, Range range,
                                float* sums) {
    weighted_powers<false, Pack<Target>>(v, weights, centre, range, sums);
  }
};

struct WeightedSquares {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows& v, const float* weights, const float* centre, Range range,
                                float* sums) {
    weighted_powers<true, Pack<Target>>(v, weights, centre, range, sums);
  }
};

struct TwoMoments {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows& v, const float* first, const float* second, const float* centre,
                                Range range, float* sums) {
    using F = Pack<Target>;
    for (int r = 0; r < v.rows; ++r) {
      const float* values = v.row(r);
      const F middle(centre[r]);
      F sum0(0.0f), square0(0.0f), sum1(0.0f), square1(0.0f);
      for (int k = range.first; k < range.first + range.count; k += F::lanes) {
        const F value = F::load(values + k), w0 = F::load(first + k), w1 = F::load(second + k);
        const F difference = value - middle;
        const F distance = difference * difference;
        sum0 = sum0 + w0 * value;
        square0 = square0 + w0 * distance;
        sum1 = sum1 + w1 * value;
        square1 = square1 + w1 * distance;
      }
      float* to = sums + moments * r;
      to[0] = sum_by_halves(sum0);
      to[1] = sum_by_halves(square0);
      to[2] = sum_by_halves(sum1);
      to[3] = sum_by_halves(square1);
    }
  }
};

struct SplitWeights {
  template <class Target>
  SLALOM_KERNEL static WeightSums<float> run(float falling, float growing, Range range, float* evaluated,
                                             float* rejected) {
    using F = Pack<Target>;
    const F down(1.0f / falling), up(1.0f / growing), zero(0.0f);
    F positive(0.0f), negative(0.0f);
    for (int k = range.first; k < range.first + range.count; k += F::lanes) {
      const F difference = F::load(evaluated + k) * down - F::load(rejected + k) * up;
      const F good = max(difference, zero), bad = max(-difference, zero);
      good.store(evaluated + k);
      bad.store(rejected + k);
      positive = positive + good;
      negative = negative + bad;
    }
    return {sum_by_halves(positive), sum_by_halves(negative), 0};
  }
};

}  // namespace

WeightSums<float> exponential_weights(const float* totals, const float* costs, float least, float temperature,
                                      Range range, float* weights) {
  return simd::dispatch<ExponentialWeights>(totals, costs, least, temperature, range, weights);
}

void scale(float factor, Range range, float* values) {
  simd::dispatch<Scale>(factor, range, values);
}

void weighted_sums(const Rows& v, const float* weights, const float* centre, Range range, float* sums) {
  simd::dispatch<WeightedSums>(v, weights, centre, range, sums);
}

void weighted_squares(const Rows& v, const float* weights, const float* centre, Range range, float* sums) {
  simd::dispatch<WeightedSquares>(v, weights, centre, range, sums);
}

void two_moments(const Rows& v, const float* first, const float* second, const float* centre, Range range,
                 float* sums) {
  simd::dispatch<TwoMoments>(v, first, second, centre, range, sums);
}

WeightSums<float> split_weights(float falling, float growing, Range range, float* evaluated,
                                float* rejected) {
  return simd::dispatch<SplitWeights>(falling, growing, range, evaluated, rejected);
}

}  // namespace slalom::detail::kernels
