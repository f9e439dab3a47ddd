#pragma once

#include <span>
#include <vector>

#include "slalom/solvers/svg_mppi_options.hpp"
#include "solvers/sampling/sample_report.hpp"

namespace slalom::detail {

/// The guide particles of SVG-MPPI: few control sequences that follow the surrogate gradient to a mode of the
/// optimal distribution, theta <- theta + epsilon g (Honda et al., ICRA 2024, section IV-A), and the Gaussian
/// fitted to the path that led there (section IV-B).
class Guides {
 public:
  /// `low` and `high` are the bounds [row] and must outlive this.
  Guides(const SvgMppiOptions& options, int inputs, std::span<const float> low, std::span<const float> high);

  /// Draws new guides from N(0, guide_variance).
  void restart(RandomKey key) noexcept;
  /// Moves the guides forward in time.
  void shift(double steps) noexcept;

  /// With `restart_guides`, puts the best guide first and lets all others begin anew round it.
  void restart_others(RandomKey key) noexcept;

  /// Moves the guides `guide_iterations` times, each with fresh samples; at most until the deadline. `key`
  /// starts the streams of the iterations. `solution` (u) and `nominal` (n) are [row]. Returns the iterations
  /// made.
  int move(const BatchEvaluator& evaluator, RandomKey key, const float* solution, const float* nominal,
           ThreadPool& pool, const Deadline& deadline) noexcept;

  /// The guide of least cost after the last move.
  int best() const noexcept { return best_; }
  bool best_collides() const noexcept { return best_collides_; }
  /// Its cost; infinite if no guide has a finite one.
  float best_cost() const noexcept { return best_cost_; }
  /// Its control sequence [row].
  std::span<const float> best_sequence() const noexcept;

  /// Variances [row] from the paths of the last move.
  void fit_variance(float* variance) noexcept;

  SequenceList sequences() const noexcept { return {guides_, count_}; }
  /// All guides after each iteration, [iteration][guide][row], and their costs.
  SequenceList path() const noexcept;
  std::span<const float> path_costs() const noexcept;

 private:
  void move_some(const BatchEvaluator& evaluator, RandomKey key, int first, int last, int iterations,
                 const Deadline& deadline, int& made) noexcept;
  void place(RandomKey key, int first, int last) noexcept;
  void step(int guide, int iteration) noexcept;
  void evaluate_ends(const BatchEvaluator& evaluator, int iterations) noexcept;
  void densities(std::span<const int> points) noexcept;

  std::size_t at(int guide) const noexcept { return static_cast<std::size_t>(guide) * rows_; }
  std::size_t path_at(int iteration, int guide) const noexcept {
    return (static_cast<std::size_t>(iteration) * static_cast<std::size_t>(count_) +
            static_cast<std::size_t>(guide));
  }

  static constexpr int restart_knots_ = 3;  ///< stretches between the knots of a deviation

  SvgMppiOptions options_;
  int inputs_;
  int count_;  ///< guides
  int block_;  ///< samples of a guide's block: its gradient samples, the guide itself, padding
  std::size_t rows_;
  std::span<const float> low_, high_;

  std::vector<double> theta_, shifted_;  ///< [guide][row]
  std::vector<float> guides_;            ///< theta as float32
  SequenceBatch batch_, ends_;           ///< one block a guide; the guides alone
  AlignedBuffer costs_, totals_, weights_, end_costs_;
  std::vector<std::uint8_t> collided_, end_collided_;
  std::vector<float> gradient_;                                               ///< [guide][row]
  std::vector<float> deviation_, inverse_;                                    ///< of gradient samples [row]
  std::vector<float> step_;                                                   ///< epsilon [row]
  std::vector<float> weight_variance_, linear_, distance_weight_, solution_;  ///< [row]
  std::vector<double> path_;                                                  ///< [iteration][guide][row]
  std::vector<float> path_float_, path_costs_;
  std::vector<int> made_, points_;  ///< iterations made [guide]; points of a fit
  std::vector<double> density_, square_, logarithm_, abscissa_;
  int iterations_ = 0;
  int best_ = 0;
  bool best_collides_ = false;
  float best_cost_ = 0;
};

}  // namespace slalom::detail
