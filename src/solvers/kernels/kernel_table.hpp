#pragma once

#include "solvers/kernels/kernels.hpp"
#include "solvers/kernels/noise_kernels.hpp"
#include "solvers/kernels/particle_kernels.hpp"
#include "solvers/kernels/published_kernels.hpp"
#include "solvers/kernels/weight_kernels.hpp"

namespace slalom::detail {

/// The table of kernels; `choice.of<Kernel>()` is the function of a kernel.
template <class Real, class Choice>
Kernels<Real> kernel_table(const Choice& choice) {
  return {.sample = choice.template of<kernel::Sample>(),
          .add_linear = choice.template of<kernel::AddLinear>(),
          .add_squared_distance = choice.template of<kernel::AddSquaredDistance>(),
          .finish = choice.template of<kernel::Finish>(),
          .make_finite = choice.template of<kernel::MakeFinite>(),
          .minimum = choice.template of<kernel::Minimum>(),
          .exponential_weights = choice.template of<kernel::ExponentialWeights>(),
          .tsallis_weights = choice.template of<kernel::TsallisWeights>(),
          .scale = choice.template of<kernel::Scale>(),
          .weighted_sums = choice.template of<kernel::WeightedSums>(),
          .weighted_squares = choice.template of<kernel::WeightedSquares>(),
          .add_scaled = choice.template of<kernel::AddScaled>(),
          .colour = choice.template of<kernel::Colour>(),
          .spread_log_normal = choice.template of<kernel::SpreadLogNormal>(),
          .particle_gradients = choice.template of<kernel::ParticleGradients>(),
          .sample_around = choice.template of<kernel::SampleAround>(),
          .stein_directions = choice.template of<kernel::SteinDirections>(),
          .two_moments = choice.template of<kernel::TwoMoments>(),
          .gather = choice.template of<kernel::Gather>(),
          .split_weights = choice.template of<kernel::SplitWeights>(),
          .published_rejection = choice.template of<kernel::PublishedRejection>(),
          .rejection_logarithm = choice.template of<kernel::RejectionLogarithm>()};
}

}  // namespace slalom::detail
