#include "solvers/kernels/kernels.hpp"

#include "slalom/core/dispatch.hpp"
#include "solvers/kernels/noise_kernels.hpp"
#include "solvers/kernels/particle_kernels.hpp"
#include "solvers/kernels/weight_kernels.hpp"

namespace slalom::detail {

namespace {

/// Compiles every kernel for one instruction set.
#define SLALOM_DEFINE_KERNELS(name, ATTRIBUTES, Target)                                                      \
  using Pack_##name = Pack<simd::Target>;                                                                    \
  ATTRIBUTES void place_##name(const Rows<float>& noise, const Rows<float>& samples,                         \
                               const SamplingDistribution<float>& to, Range range) {                         \
    body::place<Pack_##name>(noise, samples, to, range);                                                     \
  }                                                                                                          \
  ATTRIBUTES CostStatistics<float> finish_##name(const Rows<float>& v, const float* linear, Range range,     \
                                                 float* costs, float* totals) {                              \
    return body::finish<Pack_##name>(v, linear, range, costs, totals);                                       \
  }                                                                                                          \
  ATTRIBUTES void two_moments_##name(const Rows<float>& v, const float* first, const float* second,          \
                                     const float* centre, Range range, float* sums) {                        \
    body::two_moments<Pack_##name>(v, first, second, centre, range, sums);                                   \
  }                                                                                                          \
  ATTRIBUTES void gather_##name(const Rows<float>& from, const int* indices, Range range,                    \
                                const Rows<float>& to) {                                                     \
    body::gather<Pack_##name>(from, indices, range, to);                                                     \
  }                                                                                                          \
  ATTRIBUTES WeightSums<float> split_weights_##name(float falling, float growing, Range range,               \
                                                    float* evaluated, float* rejected) {                     \
    return body::split_weights<Pack_##name>(falling, growing, range, evaluated, rejected);                   \
  }                                                                                                          \
  ATTRIBUTES void add_linear_##name(const Rows<float>& v, const float* coefficient, Range range,             \
                                    float* totals) {                                                         \
    body::add_linear<Pack_##name>(v, coefficient, range, totals);                                            \
  }                                                                                                          \
  ATTRIBUTES void add_squared_distance_##name(const Rows<float>& v, const float* centre,                     \
                                              const float* weight, Range range, float* totals) {             \
    body::add_squared_distance<Pack_##name>(v, centre, weight, range, totals);                               \
  }                                                                                                          \
  ATTRIBUTES void make_finite_##name(Range range, float* costs) {                                            \
    body::make_finite<Pack_##name>(range, costs);                                                            \
  }                                                                                                          \
  ATTRIBUTES float minimum_##name(const float* costs, Range range) {                                         \
    return body::minimum<Pack_##name>(costs, range);                                                         \
  }                                                                                                          \
  ATTRIBUTES WeightSums<float> exponential_weights_##name(const float* totals, const float* costs,           \
                                                          float least, float temperature, Range range,       \
                                                          float* weights) {                                  \
    return body::exponential_weights<Pack_##name>(totals, costs, least, temperature, range, weights);        \
  }                                                                                                          \
  ATTRIBUTES WeightSums<float> tsallis_weights_##name(const float* totals, const float* costs, float least,  \
                                                      float temperature, float index, Range range,           \
                                                      float* weights) {                                      \
    return body::tsallis_weights<Pack_##name>(totals, costs, least, temperature, index, range, weights);     \
  }                                                                                                          \
  ATTRIBUTES void add_scaled_##name(const float* costs, float factor, const float* terms, Range range,       \
                                    float* totals) {                                                         \
    body::add_scaled<Pack_##name>(costs, factor, terms, range, totals);                                      \
  }                                                                                                          \
  ATTRIBUTES void colour_##name(const Rows<float>& z, const float* factor, int first, int step,              \
                                Range range) {                                                               \
    body::colour<Pack_##name>(z, factor, first, step, range);                                                \
  }                                                                                                          \
  ATTRIBUTES void spread_log_normal_##name(const Rows<float>& z, const float* y, const float* spread,        \
                                           Range range) {                                                    \
    body::spread_log_normal<Pack_##name>(z, y, spread, range);                                               \
  }                                                                                                          \
  ATTRIBUTES void scale_##name(float factor, Range range, float* values) {                                   \
    body::scale<Pack_##name>(factor, range, values);                                                         \
  }                                                                                                          \
  ATTRIBUTES void weighted_sums_##name(const Rows<float>& v, const float* weights, const float* centre,      \
                                       Range range, float* sums) {                                           \
    body::weighted_powers<false, Pack_##name>(v, weights, centre, range, sums);                              \
  }                                                                                                          \
  ATTRIBUTES void weighted_squares_##name(const Rows<float>& v, const float* weights, const float* centre,   \
                                          Range range, float* sums) {                                        \
    body::weighted_powers<true, Pack_##name>(v, weights, centre, range, sums);                               \
  }                                                                                                          \
  ATTRIBUTES void particle_gradients_##name(const ParticleGradients<float>& how, const Rows<float>& samples, \
                                            const Rows<float>& theta, Range particles, float* exponents,     \
                                            const Rows<float>& gradient) {                                   \
    body::particle_gradients<Pack_##name>(how, samples, theta, particles, exponents, gradient);              \
  }                                                                                                          \
  ATTRIBUTES void place_round_##name(const Rows<float>& samples, const Rows<float>& theta,                   \
                                     const SamplingDistribution<float>& to, int particle_stride, int count,  \
                                     Range particles) {                                                      \
    body::place_round<Pack_##name>(samples, theta, to, particle_stride, count, particles);                   \
  }                                                                                                          \
  ATTRIBUTES void stein_directions_##name(const Rows<float>& x, const Rows<float>& gradient, int count,      \
                                          float bandwidth, Range particles, const Rows<float>& phi) {        \
    body::stein_directions<Pack_##name>(x, gradient, count, bandwidth, particles, phi);                      \
  }                                                                                                          \
  ATTRIBUTES void published_rejection_##name(const Rows<float>& v, const RejectionRows<float>& densities,    \
                                             Range range, float* logarithms) {                               \
    body::published_rejection<Pack_##name>(v, densities, range, logarithms);                                 \
  }                                                                                                          \
  ATTRIBUTES void rejection_logarithm_##name(const float* rejected, float offset, Range range, float* own) { \
    body::rejection_logarithm<Pack_##name>(rejected, offset, range, own);                                    \
  }                                                                                                          \
  constexpr Kernels kernels_##name{place_##name,                                                             \
                                   add_linear_##name,                                                        \
                                   add_squared_distance_##name,                                              \
                                   finish_##name,                                                            \
                                   make_finite_##name,                                                       \
                                   minimum_##name,                                                           \
                                   exponential_weights_##name,                                               \
                                   tsallis_weights_##name,                                                   \
                                   scale_##name,                                                             \
                                   weighted_sums_##name,                                                     \
                                   weighted_squares_##name,                                                  \
                                   add_scaled_##name,                                                        \
                                   colour_##name,                                                            \
                                   spread_log_normal_##name,                                                 \
                                   particle_gradients_##name,                                                \
                                   place_round_##name,                                                       \
                                   stein_directions_##name,                                                  \
                                   two_moments_##name,                                                       \
                                   gather_##name,                                                            \
                                   split_weights_##name,                                                     \
                                   published_rejection_##name,                                               \
                                   rejection_logarithm_##name};

SLALOM_DEFINE_KERNELS(generic, SLALOM_TARGET_GENERIC, Generic)
#if SLALOM_X86
SLALOM_DEFINE_KERNELS(sse4, SLALOM_TARGET_SSE4, Sse4)
SLALOM_DEFINE_KERNELS(avx2, SLALOM_TARGET_AVX2, Avx2)
SLALOM_DEFINE_KERNELS(avx512, SLALOM_TARGET_AVX512, Avx512)
#endif

#undef SLALOM_DEFINE_KERNELS

}  // namespace

const Kernels& kernels(simd::Target target) {
#if SLALOM_X86
  switch (target) {
    case simd::Target::avx512:
      return kernels_avx512;
    case simd::Target::avx2:
      return kernels_avx2;
    case simd::Target::sse4:
      return kernels_sse4;
    case simd::Target::generic:
      break;
  }
#else
  static_cast<void>(target);
#endif
  return kernels_generic;
}

const Kernels& kernels() {
  static const Kernels& chosen = kernels(simd::active_target());
  return chosen;
}

}  // namespace slalom::detail
