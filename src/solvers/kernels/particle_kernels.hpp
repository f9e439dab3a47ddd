#pragma once

#include "solvers/kernels/kernels.hpp"
#include "solvers/kernels/lanes.hpp"

/// Kernels on sets of particles, with one particle per lane.
namespace slalom::detail::kernel {

/// Gradients of particles. The index of sample s of particle p is s * particle_stride + p.
struct ParticleGradients {
  template <class Target>
  SLALOM_KERNEL static void run(const GradientSettings<RealIn<Target>>& g, const Rows<RealIn<Target>>& v,
                                const Rows<RealIn<Target>>& theta, Range range, RealIn<Target>* exponents,
                                const Rows<RealIn<Target>>& gradient) {
    using F = PackIn<Target>;
    using L = Lanes<F>;
    using Real = RealIn<Target>;
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
};

/// Makes samples around particles from normal values: clamp(theta_p + deviation z, low, high). Samples from
/// `zero_mean_from` on are around zero.
struct SampleAround {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows<RealIn<Target>>& samples, const Rows<RealIn<Target>>& theta,
                                const SamplingDistribution<RealIn<Target>>& to, int particle_stride,
                                int count, Range range) {
    using F = PackIn<Target>;
    using L = Lanes<F>;
    using Real = RealIn<Target>;
    for (int r = 0; r < samples.rows; ++r) {
      const F deviation(to.deviation[r]), low(to.low[r]), high(to.high[r]);
      for (int s = 0; s < count; ++s) {
        Real* v = samples.row(r) + static_cast<std::ptrdiff_t>(s) * particle_stride;
        for (int p = range.first; p < range.first + range.count; p += L::count) {
          const F centre = s < to.zero_mean_from ? L::load(theta.row(r) + p) : F(0.0f);
          L::store(clamp(centre + deviation * L::load(v + p), low, high), v + p);
        }
      }
    }
  }
};

/// Kernel values below exp of this count as 0, which is negligible next to the 1 of a particle with itself.
/// Operations on subnormal values would be slow.
constexpr double min_exponent = -70;

/// phi of `packs` packs of particles that begin at particle i: see `SteinDirections`.
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
    // If fewer than `together` remain, the last particle fills the block with a kernel of 0.
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
        kernel[b][q] = select(exponent < F(Real(min_exponent)), F(0.0f), weight);
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

/// phi of the particles `range`, given all `count` particles: see stein.hpp. The sums are computed in blocks
/// of two packs of particles and four others, so that loaded values are used more than once. With the
/// repulsion split into sum_j k (g_j + c x_j) - c x_i sum_j k, each pair and row costs three operations.
struct SteinDirections {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows<RealIn<Target>>& x, const Rows<RealIn<Target>>& gradient,
                                int count, RealIn<Target> bandwidth, Range range,
                                const Rows<RealIn<Target>>& phi) {
    using F = PackIn<Target>;
    constexpr int lanes = Lanes<F>::count;
    const int end = range.first + range.count;
    int i = range.first;
    for (; i + 2 * lanes <= end; i += 2 * lanes) stein_block<2, F>(x, gradient, count, bandwidth, i, phi);
    for (; i < end; i += lanes) stein_block<1, F>(x, gradient, count, bandwidth, i, phi);
  }
};

/// -log of the probability p / (p + p_rejected) of keeping a sample, given the squared distances to the means
/// in units of the variances: log(1 + e^x) with x = (own - rejected + offset) / 2. Replaces `own`.
struct RejectionLogarithm {
  template <class Target>
  SLALOM_KERNEL static void run(const RealIn<Target>* rejected, RealIn<Target> offset, Range range,
                                RealIn<Target>* own) {
    using F = PackIn<Target>;
    using L = Lanes<F>;
    const F shift(offset), half(0.5f), one(1.0f), zero(0.0f);
    for (int k = range.first; k < range.first + range.count; k += L::count) {
      const F x = half * (L::load(own + k) - L::load(rejected + k) + shift);
      L::store(max(x, zero) + log(one + exp(-abs(x))), own + k);
    }
  }
};

}  // namespace slalom::detail::kernel
