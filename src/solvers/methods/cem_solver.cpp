#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "slalom/solvers/cem_options.hpp"
#include "solvers/sampling/sample_report.hpp"

namespace slalom {

namespace {

/// `cem`, the cross-entropy method (Rubinstein 1999; Kobilarov 2012): draws samples, fits mean and variance
/// to the fraction with the lowest costs, and repeats this.
class CemSolver final : public SolverBase {
 public:
  CemSolver(const CemOptions& options, int inputs, std::shared_ptr<ThreadPool> pool)
      : SolverBase(options, inputs, std::move(pool)),
        options_(options),
        samples_(options.horizon, inputs, options.samples,
                 detail::NoiseShape(options.noise.exponent, options.noise.log_normal_spread, options.horizon,
                                    inputs, options.samples)),
        elites_(std::clamp(static_cast<int>(std::lround(options.elite_share * options.samples)), 1,
                           options.samples)),
        order_(options.samples),
        mean_(size()),
        variance_(size()),
        first_variance_(spread(options.variance)),
        min_variance_(spread(options.variance_min)),
        deviation_(size()),
        zero_(size()),
        elite_mean_(size()),
        best_(size()),
        sums_(size()) {
    reset(options.seed);
  }

  const char* name() const noexcept override { return CemOptions::method; }

  void reset(std::uint64_t seed) noexcept override {
    restart(seed);
    std::fill(mean_.begin(), mean_.end(), 0.0f);
    clamp(mean_.data());
    std::copy(mean_.begin(), mean_.end(), best_.begin());
    std::copy(first_variance_.begin(), first_variance_.end(), variance_.begin());
    result_ = {};
    result_.mean = mean_;
    result_.inputs = options_.send_best ? best_ : mean_;
    result_.nominal = zero_;
    result_.variances = variance_;
  }

  const SolveResult& solve(const BatchEvaluator& evaluator, const SolveRequest& request) noexcept override {
    const auto begin = detail::Clock::now();
    const Deadline deadline(begin, request.deadline);
    result_.times = {};
    if (options_.shift_warm_start) shift(warm_start_shift(evaluator, request));
    std::copy(first_variance_.begin(), first_variance_.end(), variance_.begin());

    detail::BatchStatistics statistics;
    Status status = Status::deadline;
    float best_cost = std::numeric_limits<float>::infinity();
    int iteration = 0;
    for (; iteration < options_.iterations && !deadline.passed(); ++iteration) {
      for (std::size_t r = 0; r < size(); ++r) deviation_[r] = std::sqrt(variance_[r]);
      statistics = samples_.draw_and_evaluate(evaluator, key(iteration),
                                              {mean_.data(), deviation_.data(), low().data(), high().data(),
                                               zero_mean_from(samples_.samples(), options_.zero_mean_share)},
                                              nullptr, pool(), deadline);
      result_.times.draw += statistics.draw_time;
      result_.times.evaluate += statistics.evaluate_time;
      status = statistics.finite == 0 ? Status::degenerate : Status::ok;
      if (status != Status::ok || statistics.evaluated == 0) break;
      refit(best_cost);
    }
    if (status == Status::ok &&
        (iteration < options_.iterations || statistics.evaluated < samples_.samples()))
      status = Status::deadline;
    if (statistics.evaluated == 0) status = Status::deadline;
    if (status == Status::ok && statistics.collided == samples_.samples()) status = Status::all_collided;
    if (!(best_cost < std::numeric_limits<float>::infinity()))
      std::copy(mean_.begin(), mean_.end(), best_.begin());
    result_.status = status;
    result_.iterations = iteration;
    const StageTimes times = result_.times;
    detail::report_samples(samples_, statistics, samples_.sum_weights(), result_);
    result_.times = times;
    next_solve();
    result_.times.total = detail::seconds(begin, detail::Clock::now());
    return result_;
  }

 private:
  void shift(double steps) noexcept {
    if (!(steps > 0)) return;
    shift_sequence(mean_.data(), horizon(), inputs(), steps, elite_mean_.data());
    std::copy(elite_mean_.begin(), elite_mean_.end(), mean_.begin());
  }

  /// Fits the distribution to the elites, which have equal weights.
  void refit(float& best_cost) noexcept {
    const auto begin = detail::Clock::now();
    const auto costs = samples_.costs();
    std::iota(order_.begin(), order_.end(), 0);
    // The smaller index wins ties, so that the choice does not depend on the library's algorithm.
    const auto better = [&](int a, int b) { return costs[a] < costs[b] || (costs[a] == costs[b] && a < b); };
    std::nth_element(order_.begin(), order_.begin() + elites_ - 1, order_.end(), better);
    std::fill(samples_.weights().begin(), samples_.weights().end(), 0.0f);
    int used = 0, best = order_[0];
    for (int i = 0; i < elites_; ++i) {
      const int k = order_[i];
      if (std::isfinite(costs[k])) ++used;
      if (better(k, best)) best = k;
    }
    for (int i = 0; i < elites_; ++i) {
      const int k = order_[i];
      if (std::isfinite(costs[k])) samples_.weights()[k] = 1.0f / used;
    }
    if (costs[best] < best_cost) {
      best_cost = costs[best];
      samples_.values().get_sample(best, best_);
    }
    samples_.weighted_sums(zero_.data(), sums_.data(), pool());
    std::copy(sums_.begin(), sums_.end(), elite_mean_.begin());
    samples_.weighted_squares(elite_mean_.data(), sums_.data(), pool());
    const float kept = static_cast<float>(options_.smoothing);
    for (std::size_t r = 0; r < size(); ++r) {
      const float least = std::min(min_variance_[r], first_variance_[r]);
      const float variance = static_cast<float>(sums_[r]);
      variance_[r] = std::clamp(variance + kept * (variance_[r] - variance), least, 1e12f);
      mean_[r] = elite_mean_[r] + kept * (mean_[r] - elite_mean_[r]);
    }
    clamp(mean_.data());
    result_.times.update += detail::seconds(begin, detail::Clock::now());
  }

  CemOptions options_;
  detail::SampleSet samples_;
  int elites_;
  std::vector<int> order_;
  std::vector<float> mean_, variance_, first_variance_, min_variance_, deviation_, zero_, elite_mean_,
      best_;                  ///< [row]
  std::vector<double> sums_;  ///< [row]
  SolveResult result_;
};

}  // namespace

std::unique_ptr<Solver> make_solver(const CemOptions& options, int inputs, std::shared_ptr<ThreadPool> pool) {
  validate_options(options, CemOptions::method, inputs);
  return std::make_unique<CemSolver>(options, inputs, std::move(pool));
}

}  // namespace slalom
