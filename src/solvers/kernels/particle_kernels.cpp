#include "solvers/kernels/kernels.hpp"

#include <cstring>
#include <limits>

#include "slalom/core/dispatch.hpp"
#include "slalom/core/math.hpp"

namespace slalom::detail::kernels {

namespace {

/// The index of sample s of particle p is s * particle_stride + p.
struct ParticleGradients {
  template <class Target>
  SLALOM_KERNEL static void run(const GradientSettings& g, const Rows& v, const Rows& theta, Range range,
                                float* exponents, const Rows& gradient) {
    using F = Pack<Target>;
    const F infinite(std::numeric_limits<float>::infinity()), zero(0.0f);
    for (int p = range.first; p < range.first + range.count; p += F::lanes) {
      F least = infinite;
      for (int s = 0; s < g.samples; ++s) {
        const std::ptrdiff_t at = s * g.particle_stride + p;
        F exponent = F::load(exponents + at) * F(1.0f / g.temperature);
        for (int r = 0; r < v.rows; ++r) exponent = exponent + F(g.linear[r]) * F::load(v.row(r) + at);
        exponent = select(abs(exponent) < infinite, exponent, infinite);
        exponent.store(exponents + at);
        least = min(least, exponent);
      }
      const auto usable = least < infinite;
      const F base = select(usable, least, zero);
      F sum = zero;
      for (int s = 0; s < g.samples; ++s) {
        const std::ptrdiff_t at = s * g.particle_stride + p;
        const F w = exp(base - F::load(exponents + at));
        w.store(exponents + at);
        sum = sum + w;
      }
      const F floor = g.subtract_minimum ? F(g.floor) : F(g.floor) * exp(base);
      const F normaliser = F(1.0f) / (sum + floor);
      for (int r = 0; r < v.rows; ++r) {
        const F centre = F::load(theta.row(r) + p);
        F moved = zero;
        for (int s = 0; s < g.samples; ++s) {
          const std::ptrdiff_t at = s * g.particle_stride + p;
          moved = moved + F::load(exponents + at) * (F::load(v.row(r) + at) - centre);
        }
        select(usable, F(g.inverse_variance[r]) * moved * normaliser, zero).store(gradient.row(r) + p);
      }
    }
  }
};

struct SampleAround {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows& samples, const Rows& theta, const SamplingDistribution& to,
                                int particle_stride, int count, Range range) {
    using F = Pack<Target>;
    for (int r = 0; r < samples.rows; ++r) {
      const F deviation(to.deviation[r]), low(to.low[r]), high(to.high[r]);
      for (int s = 0; s < count; ++s) {
        float* v = samples.row(r) + static_cast<std::ptrdiff_t>(s) * particle_stride;
        for (int p = range.first; p < range.first + range.count; p += F::lanes) {
          const F centre = s < to.zero_mean_from ? F::load(theta.row(r) + p) : F(0.0f);
          clamp(centre + deviation * F::load(v + p), low, high).store(v + p);
        }
      }
    }
  }
};

/// Kernel values below exp of this count as 0, which is negligible next to the 1 of a particle with itself.
/// Operations on subnormal values would be slow.
constexpr float min_exponent = -70;

/// phi of `packs` packs of particles that begin at particle i: see `SteinDirections`.
template <int packs, class F>
SLALOM_INLINE void stein_block(const Rows& x, const Rows& gradient, int count, float bandwidth, int i,
                               const Rows& phi) {
  constexpr int together = 4;
  const F negative_inverse(-1.0f / bandwidth), repulsion(-2.0f / bandwidth),
      share(1.0f / static_cast<float>(count));
  for (int r = 0; r < x.rows; ++r)
    for (int b = 0; b < packs; ++b) F(0.0f).store(phi.row(r) + i + b * F::lanes);
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
      const float* at = x.row(r);
      for (int b = 0; b < packs; ++b) {
        const F own = F::load(at + i + b * F::lanes);
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
        kernel[b][q] = select(exponent < F(min_exponent), F(0.0f), weight);
        kernel_sum[b] = kernel_sum[b] + kernel[b][q];
      }
    }
    for (int r = 0; r < x.rows; ++r) {
      F pull[together];
      for (int q = 0; q < together; ++q)
        pull[q] = F(gradient.row(r)[other[q]]) + repulsion * F(x.row(r)[other[q]]);
      for (int b = 0; b < packs; ++b) {
        F sum = F::load(phi.row(r) + i + b * F::lanes);
        for (int q = 0; q < together; ++q) sum = sum + kernel[b][q] * pull[q];
        sum.store(phi.row(r) + i + b * F::lanes);
      }
    }
  }
  for (int r = 0; r < x.rows; ++r) {
    for (int b = 0; b < packs; ++b) {
      float* to = phi.row(r) + i + b * F::lanes;
      (F::load(to) - repulsion * kernel_sum[b] * F::load(x.row(r) + i + b * F::lanes)).store(to);
    }
  }
}

/// The sums are computed in blocks of two packs of particles and four others, so that loaded values are used
/// more than once. With the repulsion split into sum_j k (g_j + c x_j) - c x_i sum_j k, each pair and row
/// costs three operations.
struct SteinDirections {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows& x, const Rows& gradient, int count, float bandwidth, Range range,
                                const Rows& phi) {
    using F = Pack<Target>;
    constexpr int lanes = F::lanes;
    const int end = range.first + range.count;
    int i = range.first;
    for (; i + 2 * lanes <= end; i += 2 * lanes) stein_block<2, F>(x, gradient, count, bandwidth, i, phi);
    for (; i < end; i += lanes) stein_block<1, F>(x, gradient, count, bandwidth, i, phi);
  }
};

/// Sums the lanes in pairs, which has fewer roundings per value and a shorter chain of dependent additions.
template <class F>
SLALOM_INLINE float sum_by_halves(const F& value) {
  float part[F::lanes];
  value.store(part);
  for (int n = F::lanes / 2; n > 0; n /= 2)
    for (int i = 0; i < n; ++i) part[i] += part[i + n];
  return part[0];
}

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

struct Gather {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows& from, const int* indices, Range range, const Rows& to) {
    using F = Pack<Target>;
    for (int k = range.first; k < range.first + range.count; k += F::lanes) {
      simd::IntPack<Target> index;
      std::memcpy(&index.v, indices + k, sizeof index.v);
      for (int r = 0; r < from.rows; ++r) {
        F gathered;
        simd::Operations<Target>::gather(from.row(r), index.v, gathered.v);
        gathered.store(to.row(r) + k);
      }
    }
  }
};

/// The logarithm of a product of many factors, computed with a single logarithm: the product is stored as a
/// number in [1, 2) and an exponent.
template <class F>
class LongProduct {
 public:
  SLALOM_INLINE void multiply(const F& factor) { product_ = product_ * factor; }
  /// Normalises the product. To be called after at most two factors, so that it cannot overflow.
  SLALOM_INLINE void settle() {
    const auto bits = reinterpret_cast<Integers>(product_.v);
    exponent_ = exponent_ + ((bits >> 23) - 127);
    product_ = F(reinterpret_cast<typename F::Vector>((bits & 0x007fffff) | 0x3f800000));
  }
  SLALOM_INLINE F logarithm() const {
    const F n(__builtin_convertvector(exponent_, typename F::Vector));
    return log(product_) + n * F(-2.12194440e-4f) + n * F(0.693359375f);
  }

 private:
  using Integers = typename simd::IntPack<typename F::Target>::Vector;

  F product_ = F(1.0f);
  Integers exponent_{};
};

/// log of prod over rows of (base + density), the inverse of the published program's probability of keeping a
/// sample: density = exp((v - mean)^2 / deviation) / sqrt(2 pi variance); for base see `RejectionRows`.
struct PublishedRejection {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows& v, const RejectionRows& d, Range range, float* logarithms) {
    using F = Pack<Target>;
    for (int k = range.first; k < range.first + range.count; k += F::lanes) {
      LongProduct<F> product;
      for (int r = 0; r < v.rows; ++r) {
        const F difference = F::load(v.row(r) + k) - F(d.rejected_mean[r]);
        const F density = exp(difference * difference * F(d.rejected_inverse[r])) * F(d.rejected_scale[r]);
        product.multiply(F(d.base[r]) + density);
        if (r % 2 == 1 || r + 1 == v.rows) product.settle();
      }
      product.logarithm().store(logarithms + k);
    }
  }
};

/// -log of the probability p / (p + p_rejected) of keeping a sample, given the squared distances to the means
/// in units of the variances: log(1 + e^x) with x = (own - rejected + offset) / 2. Replaces `own`.
struct RejectionLogarithm {
  template <class Target>
  SLALOM_KERNEL static void run(const float* rejected, float offset, Range range, float* own) {
    using F = Pack<Target>;
    const F shift(offset), half(0.5f), one(1.0f), zero(0.0f);
    for (int k = range.first; k < range.first + range.count; k += F::lanes) {
      const F x = half * (F::load(own + k) - F::load(rejected + k) + shift);
      (max(x, zero) + log(one + exp(-abs(x)))).store(own + k);
    }
  }
};

}  // namespace

void particle_gradients(const GradientSettings& how, const Rows& samples, const Rows& theta, Range particles,
                        float* exponents, const Rows& gradient) {
  simd::dispatch<ParticleGradients>(how, samples, theta, particles, exponents, gradient);
}

void sample_around(const Rows& samples, const Rows& theta, const SamplingDistribution& to,
                   int particle_stride, int count, Range particles) {
  simd::dispatch<SampleAround>(samples, theta, to, particle_stride, count, particles);
}

void stein_directions(const Rows& x, const Rows& gradient, int count, float bandwidth, Range particles,
                      const Rows& phi) {
  simd::dispatch<SteinDirections>(x, gradient, count, bandwidth, particles, phi);
}

void gather(const Rows& from, const int* indices, Range range, const Rows& to) {
  simd::dispatch<Gather>(from, indices, range, to);
}

void published_rejection(const Rows& v, const RejectionRows& densities, Range range, float* logarithms) {
  simd::dispatch<PublishedRejection>(v, densities, range, logarithms);
}

void rejection_logarithm(const float* rejected, float offset, Range range, float* own) {
  simd::dispatch<RejectionLogarithm>(rejected, offset, range, own);
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
