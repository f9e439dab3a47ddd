#pragma once

#include <span>
#include <vector>

#include "slalom/solvers/svg_mppi_options.hpp"
#include "solvers/kernels/kernels.hpp"
#include "solvers/sampling/noise_shape.hpp"
#include "solvers/sampling/sample_set.hpp"

namespace slalom::detail {

/// The gradient of log E[w] at a particle theta, estimated from samples v_i ~ N(theta, Sigma_g) without
/// derivatives of the cost (Lambert et al., "Stein Variational Model Predictive Control", CoRL 2020; Honda et
/// al., ICRA 2024, equation (11)):
///
///     g = sum_i w_i Sigma_g^-1 (v_i - theta) / (sum_i w_i + floor),   w_i = exp(-J_i / lambda)
///
/// J is the cost S with the terms that the method adds to it. With `subtract_minimum`, w_i = exp(-(J_i - min
/// J) / lambda); this makes a difference only if the floor is not 0. Without it, the floor stops a particle
/// whose samples are all bad. The weights are computed relative to the minimum in both cases, so that they do
/// not all underflow; the floor is scaled accordingly.
struct SurrogateGradient {
  float temperature = 0;                    ///< lambda; 0: follows from the costs
  bool subtract_minimum = true;             ///< whether the weights are relative to the lowest J
  double floor = 0;                         ///< added to the sum of the weights
  const float* centre = nullptr;            ///< theta [row]
  const float* inverse_variance = nullptr;  ///< inverse variances of the samples, [row]
  const float* linear = nullptr;            ///< J += sum linear[row] v[row]; may be null
  const float* distance_centre = nullptr;   ///< J += sum distance_weight (v - distance_centre)^2; may be null
  const float* distance_weight = nullptr;   ///< [row]
};

/// Computes the gradient g [row] from the first `samples` samples of the range `block` of `v`. `block.count`
/// is a multiple of the lanes. `totals` holds the costs S and is replaced by J. `weights` is scratch memory
/// of the same length. Returns false, with g = 0, if no J is finite.
bool surrogate_gradient(const SurrogateGradient& s, const Rows& v, Range block, int samples, float* totals,
                        float* weights, float* gradient) noexcept;

/// The guide particles of SVG-MPPI (Honda et al., ICRA 2024): a few control sequences that follow the
/// surrogate gradient to a mode of the optimal distribution, theta <- theta + epsilon g (equations (9) to
/// (11)). A Gaussian is fitted to the path of the best guide (equations (12) and (13)).
class Guides {
 public:
  /// `low` and `high` are the bounds [row].
  Guides(const SvgMppiOptions& options, int inputs, std::span<const float> low, std::span<const float> high);

  /// Draws new guides from N(0, guide_variance).
  void restart(RandomKey key) noexcept;
  /// Shifts the guides forward in time by a number of steps, which may be fractional.
  void shift(double steps) noexcept;

  /// Computes the guides' costs from the present state, and replaces the worst guide by `solution` [row] if
  /// that costs less.
  void take_in(const BatchEvaluator& evaluator, const float* solution) noexcept;

  /// With `restart_guides`, moves the best guide to index 0 and draws all others around it.
  void restart_others(RandomKey key) noexcept;

  /// Moves the guides `guide_iterations` times, each time with new samples, in three parts: `begin_move`,
  /// `move_share` for each share, which may run at the same time, and `end_move`. `solution` (u) and
  /// `nominal` (n) are [row]; `shares` is in [1, number of guides].
  void begin_move(const float* solution, const float* nominal, int shares) noexcept;
  /// Moves the guides of one share, until the deadline. Iteration l uses the random stream `key.stream` + l.
  void move_share(int share, const BatchEvaluator& evaluator, RandomKey key,
                  const Deadline& deadline) noexcept;
  /// Selects the best guide (equation (12)). Returns the number of iterations made.
  int end_move(const BatchEvaluator& evaluator) noexcept;

  /// The cost of the best guide; infinite if no guide has a finite cost.
  float best_cost() const noexcept { return best_cost_; }
  /// The control sequence [row] of the best guide.
  std::span<const float> best_sequence() const noexcept;

  /// Fits the variances [row] to the paths of the last move (equation (13)), within `variance_min` and
  /// `variance_max`. `temperature` is that of q*; 0 if it is unknown yet: they are then `variance_max`.
  void fit_variance(double temperature, float* variance) noexcept;
  /// The cost of a control sequence [row] from the present state; infinite if it is not finite.
  float cost(const BatchEvaluator& evaluator, const float* sequence) noexcept;

  /// All guides.
  SequenceList sequences() const noexcept { return {guides_.values(), count_}; }
  /// All guides after each iteration of the last move, [iteration][guide][row].
  SequenceList path() const noexcept;
  /// The costs of the points of `path` [iteration][guide].
  std::span<const float> path_costs() const noexcept;

 private:
  void fill_blocks(RandomKey key, int first, int last) noexcept;
  void estimate_gradient(int guide) noexcept;
  void step(int guide, int iteration) noexcept;
  void densities(double temperature, std::span<const int> points) noexcept;
  double fit_row(int r, std::span<const int> points) noexcept;

  /// The factor between the control terms of weights and inverse variances; 1 where the temperature follows
  /// from the costs, which is allowed for weights without such a term alone.
  double weight_temperature() const noexcept {
    return options_.guides.gradient_temperature > 0 ? options_.guides.gradient_temperature : 1;
  }
  /// The index of a point of the paths: a guide after an iteration.
  int point(int iteration, int guide) const noexcept { return iteration * count_ + guide; }
  /// Copies `theta_` to `guides_`.
  void round_to_float() noexcept;

  /// The first guide of a share, whose guides have consecutive indices.
  int first_guide(int share) const noexcept { return count_ * share / shares_; }

  static constexpr int restart_intervals_ = 3;  ///< number of intervals between knots of a deviation

  SvgMppiOptions options_;
  int inputs_;
  int count_;             ///< guides
  int gradient_samples_;  ///< samples for the gradient of a guide
  int block_;             ///< samples of a guide's block: its gradient samples, the guide itself, padding
  int rows_;              ///< values of a control sequence
  std::vector<float> low_, high_;  ///< bounds [row]

  NoiseShape shape_;                ///< shape of pinned noise; of other noise, guides are not correlated
  Matrix<double> theta_, shifted_;  ///< [guide][row]
  Matrix<float> guides_;            ///< theta as float32
  SequenceBatch batch_;             ///< one block for each guide
  SequenceBatch ends_;              ///< the guides alone, and room for one more
  AlignedBuffer costs_, totals_, weights_, end_costs_;
  std::vector<std::uint8_t> collided_, end_collided_;
  Matrix<float> gradient_;                  ///< [guide][row]
  std::vector<float> deviation_, inverse_;  ///< standard deviation, 1 / variance of gradient samples [row]
  std::vector<float> step_;                 ///< epsilon [row]
  std::vector<float> weight_variance_, linear_, distance_weight_, solution_;  ///< [row]
  Matrix<double> path_;                                                       ///< [point][row]
  Matrix<float> path_float_;                                                  ///< `path_` as float32
  std::vector<float> path_costs_;                                             ///< [point]
  std::vector<int> made_;                                                     ///< iterations made [share]
  std::vector<int> fit_points_;  ///< indices of the fitted points
  double log_error_ = 0;         ///< error of the logarithms of the densities, from the rounding of the costs
  std::vector<double> density_, square_, logarithm_, abscissa_;  ///< [fitted point]
  int shares_ = 1;
  int iterations_ = 0;
  int best_ = 0;
  float best_cost_ = 0;
};

}  // namespace slalom::detail
