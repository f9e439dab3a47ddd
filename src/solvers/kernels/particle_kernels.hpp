#pragma once

#include "solvers/kernels/weight_kernels.hpp"

/// Bodies of the kernels that work on sets of particles, one particle a lane.
namespace slalom::detail::body {

/// Gradients of particles. Sample s of particle p stands at s * particle_stride + p.
template <class F>
SLALOM_INLINE void particle_gradients(const ParticleGradients<RealOf<F>>& g, const Rows<RealOf<F>>& v,
                                      const Rows<RealOf<F>>& theta, Range range, RealOf<F>* exponents,
                                      const Rows<RealOf<F>>& gradient) {
  using L = Lanes<F>;
  using Real = RealOf<F>;
  const F infinite(std::numeric_limits<Real>::infinity()), zero(0.0f);
  for (int p = range.first; p < range.first + range.count; p += L::count) {
    F least = infinite;
    for (int s = 0; s < g.samples; ++s) {
      const std::ptrdiff_t at = s * g.particle_stride + p;
      F exponent = L::load(exponents + at) * F(Real(1) / g.temperature);
      for (int r = 0; r < v.rows; ++r) exponent = exponent + F(g.linear[r]) * L::load(v.row(r) + at);
      exponent = select(abs(exponent) < infinite, exponent, infinite);
      L::store(exponent, exponents + at);
      least = min(least, exponent);
    }
    const auto usable = least < infinite;
    const F base = select(usable, least, zero);
    F sum = zero;
    for (int s = 0; s < g.samples; ++s) {
      const std::ptrdiff_t at = s * g.particle_stride + p;
      const F w = exp(base - L::load(exponents + at));
      L::store(w, exponents + at);
      sum = sum + w;
    }
    const F floor = g.subtract_minimum ? F(g.floor) : F(g.floor) * exp(base);
    const F normaliser = F(Real(1)) / (sum + floor);
    for (int r = 0; r < v.rows; ++r) {
      const F centre = L::load(theta.row(r) + p);
      F moved = zero;
      for (int s = 0; s < g.samples; ++s) {
        const std::ptrdiff_t at = s * g.particle_stride + p;
        moved = moved + L::load(exponents + at) * (L::load(v.row(r) + at) - centre);
      }
      L::store(select(usable, F(g.inverse_variance[r]) * moved * normaliser, zero), gradient.row(r) + p);
    }
  }
}

/// Normal values to samples round particles: clamp(theta_p + deviation z, low, high), or round zero for the
/// samples from `zero_mean_from` on.
template <class F>
SLALOM_INLINE void place_round(const Rows<RealOf<F>>& samples, const Rows<RealOf<F>>& theta,
                               const SamplingDistribution<RealOf<F>>& to, int particle_stride, int count,
                               Range range) {
  using L = Lanes<F>;
  for (int r = 0; r < samples.rows; ++r) {
    const F deviation(to.deviation[r]), low(to.low[r]), high(to.high[r]);
    for (int s = 0; s < count; ++s) {
      RealOf<F>* v = samples.row(r) + static_cast<std::ptrdiff_t>(s) * particle_stride;
      for (int p = range.first; p < range.first + range.count; p += L::count) {
        const F centre = s < to.zero_mean_from ? L::load(theta.row(r) + p) : F(0.0f);
        L::store(clamp(centre + deviation * L::load(v + p), low, high), v + p);
      }
    }
  }
}

/// Kernels below exp of this count as 0 beside the 1 of a particle with itself: subnormal ones would make
/// every operation on them slow.
constexpr double least_exponent = -70;

/// phi of `packs` packs of particles from `i` on: see `stein_directions`.
template <int packs, class F>
SLALOM_INLINE void stein_block(const Rows<RealOf<F>>& x, const Rows<RealOf<F>>& gradient, int count,
                               RealOf<F> bandwidth, int i, const Rows<RealOf<F>>& phi) {
  using L = Lanes<F>;
  using Real = RealOf<F>;
  constexpr int together = 4;
  const F negative_inverse(Real(-1) / bandwidth), repulsion(Real(-2) / bandwidth),
      share(Real(1) / Real(count));
  for (int r = 0; r < x.rows; ++r)
    for (int b = 0; b < packs; ++b) L::store(F(0.0f), phi.row(r) + i + b * L::count);
  F kernel_sum[packs];
  for (int b = 0; b < packs; ++b) kernel_sum[b] = F(0.0f);
  for (int j = 0; j < count; j += together) {
    // Where fewer are left, the last one stands in for those that lack, with a kernel of zero.
    int other[together];
    for (int q = 0; q < together; ++q) other[q] = j + q < count ? j + q : count - 1;
    F kernel[packs][together];
    for (int b = 0; b < packs; ++b)
      for (int q = 0; q < together; ++q) kernel[b][q] = F(0.0f);
    for (int r = 0; r < x.rows; ++r) {
      const Real* at = x.row(r);
      for (int b = 0; b < packs; ++b) {
        const F own = L::load(at + i + b * L::count);
        for (int q = 0; q < together; ++q) {
          const F difference = F(at[other[q]]) - own;
          kernel[b][q] = kernel[b][q] + difference * difference;
        }
      }
    }
    for (int b = 0; b < packs; ++b) {
      for (int q = 0; q < together; ++q) {
        const F exponent = kernel[b][q] * negative_inverse;
        const F weight = exp(exponent) * (j + q < count ? share : F(0.0f));
        kernel[b][q] = select(exponent < F(Real(least_exponent)), F(0.0f), weight);
        kernel_sum[b] = kernel_sum[b] + kernel[b][q];
      }
    }
    for (int r = 0; r < x.rows; ++r) {
      F pull[together];
      for (int q = 0; q < together; ++q)
        pull[q] = F(gradient.row(r)[other[q]]) + repulsion * F(x.row(r)[other[q]]);
      for (int b = 0; b < packs; ++b) {
        F sum = L::load(phi.row(r) + i + b * L::count);
        for (int q = 0; q < together; ++q) sum = sum + kernel[b][q] * pull[q];
        L::store(sum, phi.row(r) + i + b * L::count);
      }
    }
  }
  for (int r = 0; r < x.rows; ++r) {
    for (int b = 0; b < packs; ++b) {
      Real* to = phi.row(r) + i + b * L::count;
      L::store(L::load(to) - repulsion * kernel_sum[b] * L::load(x.row(r) + i + b * L::count), to);
    }
  }
}

/// phi of the particles `range`, from all `count` particles: see stein.hpp. The kernel sum is taken in blocks
/// of two packs of particles and four others, so that what is loaded serves more than once; with the
/// repulsion's own part apart, sum_j k (g_j + c x_j) - c x_i sum_j k, a pair and row costs three operations.
template <class F>
SLALOM_INLINE void stein_directions(const Rows<RealOf<F>>& x, const Rows<RealOf<F>>& gradient, int count,
                                    RealOf<F> bandwidth, Range range, const Rows<RealOf<F>>& phi) {
  constexpr int lanes = Lanes<F>::count;
  const int end = range.first + range.count;
  int i = range.first;
  for (; i + 2 * lanes <= end; i += 2 * lanes) stein_block<2, F>(x, gradient, count, bandwidth, i, phi);
  for (; i < end; i += lanes) stein_block<1, F>(x, gradient, count, bandwidth, i, phi);
}

/// A product of many factors as its logarithm, which takes one logarithm for all: what has been multiplied is
/// kept as a number in [1, 2) and an exponent.
template <class F>
class LongProduct {
 public:
  SLALOM_INLINE void multiply(const F& factor) { product_ = product_ * factor; }
  /// After at most two factors, or they could overflow.
  SLALOM_INLINE void settle() {
    if constexpr (is_pack<F>) {
      using V = typename F::Vector;
      const auto bits = reinterpret_cast<Integers>(product_.v);
      exponent_ = exponent_ + ((bits >> 23) - 127);
      product_ = F(reinterpret_cast<V>((bits & 0x007fffff) | 0x3f800000));
    } else {
      logarithm_ += log(product_);
      product_ = 1;
    }
  }
  SLALOM_INLINE F logarithm() const {
    if constexpr (is_pack<F>) {
      const F n(__builtin_convertvector(exponent_, typename F::Vector));
      return log(product_) + n * F(-2.12194440e-4f) + n * F(0.693359375f);
    } else {
      return logarithm_;
    }
  }

 private:
  template <class G>
  struct IntegersOf {
    using type = double;
  };
  template <class T>
  struct IntegersOf<Pack<T>> {
    using type = typename simd::IntPack<T>::Vector;
  };
  using Integers = typename IntegersOf<F>::type;

  F product_ = F(1.0f);
  F logarithm_ = F(0.0f);
  Integers exponent_{};
};

/// log of prod over rows of (base + density), the inverse of the published program's probability of keeping a
/// sample: density = exp((v - mean)^2 / deviation) / sqrt(2 pi variance), base the like at another place.
template <class F>
SLALOM_INLINE void published_rejection(const Rows<RealOf<F>>& v, const RejectionRows<RealOf<F>>& d,
                                       Range range, RealOf<F>* logarithms) {
  using L = Lanes<F>;
  for (int k = range.first; k < range.first + range.count; k += L::count) {
    LongProduct<F> product;
    for (int r = 0; r < v.rows; ++r) {
      const F difference = L::load(v.row(r) + k) - F(d.rejected_mean[r]);
      const F density = exp(difference * difference * F(d.rejected_inverse[r])) * F(d.rejected_scale[r]);
      product.multiply(F(d.base[r]) + density);
      if (r % 2 == 1 || r + 1 == v.rows) product.settle();
    }
    L::store(product.logarithm(), logarithms + k);
  }
}

/// -log of the probability p / (p + p_rejected) of keeping a sample, from squared distances to the means in
/// units of the variances: log(1 + e^x) with x = (own - rejected + offset) / 2. Replaces `own`.
template <class F>
SLALOM_INLINE void rejection_logarithm(const RealOf<F>* rejected, RealOf<F> offset, Range range,
                                       RealOf<F>* own) {
  using L = Lanes<F>;
  const F shift(offset), half(0.5f), one(1.0f), zero(0.0f);
  for (int k = range.first; k < range.first + range.count; k += L::count) {
    const F x = half * (L::load(own + k) - L::load(rejected + k) + shift);
    L::store(max(x, zero) + log(one + exp(-abs(x))), own + k);
  }
}

}  // namespace slalom::detail::body
