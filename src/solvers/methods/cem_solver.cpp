#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/option_access.hpp"
#include "slalom/solvers/cem_options.hpp"
#include "slalom/solvers/default_variances.hpp"
#include "slalom/solvers/icem_options.hpp"
#include "solvers/methods/method_solver.hpp"
#include "solvers/sampling/sample_set.hpp"

namespace slalom {

namespace {

/// The additions of `icem` to `cem`; none with these defaults.
struct Memory {
  double kept_elite_share = 0;  ///< xi, of the elites, that stay as samples
  double sample_decay = 1;      ///< gamma, by which every iteration has fewer samples
  bool add_mean = false;        ///< the mean is a sample of the last iteration
};

/// The number of elites in batches of which the first has so many samples.
int elites_of(const CemOptions& o, int samples) {
  return std::clamp(saturate_cast<int>(std::round(o.elite_share * samples)), 1, samples);
}

/// Divides the rollouts of a solve among its iterations, each of which has 1 / gamma of the samples of the
/// one before, and at least twice the elites.
std::vector<int> batch_sizes(const CemOptions& o, double decay) {
  std::vector<double> ends;
  double size = 1, end = 0;
  for (int i = 0; i < o.iterations; ++i, size /= decay) ends.push_back(end += size);
  std::vector<int> sizes;
  int drawn = 0, least = 1;
  for (const double to : ends) {
    const int wanted = saturate_cast<int>(std::ceil(o.samples * (to / end))) - drawn;
    sizes.push_back(sizes.empty() ? wanted : std::clamp(wanted, least, sizes[0]));
    if (drawn == 0) least = std::min(2 * elites_of(o, sizes[0]), sizes[0]);
    drawn += sizes.back();
  }
  return sizes;
}

/// `cem`, the cross-entropy method (Rubinstein 1999; Kobilarov 2012): draws samples, fits mean and variance
/// to the fraction with the lowest costs, and repeats this. With `Memory` it is `icem` (Pinneri et al. 2020,
/// algorithm 1).
class CemSolver final : public detail::MethodSolver<CemSolver> {
 public:
  CemSolver(const char* name, const CemOptions& options, const Memory& memory, int inputs,
            std::shared_ptr<ThreadPool> pool)
      : MethodSolver(options, inputs, std::move(pool)),
        name_(name),
        options_(options),
        memory_(memory),
        sizes_(batch_sizes(options, memory.sample_decay)),
        batch_(options.horizon, inputs, sizes_[0],
               detail::NoiseShape(options.noise, options.horizon, inputs)),
        elites_(elites_of(options, sizes_[0])),
        max_kept_(saturate_cast<int>(std::round(memory.kept_elite_share * elites_))),
        order_(sizes_[0]),
        kept_(static_cast<std::size_t>(max_kept_ + 1) * size()),
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

  const char* name() const noexcept override { return name_; }

  bool takes_proposals() const noexcept override { return true; }

  void reset(std::uint64_t seed) noexcept override {
    restart(seed);
    std::fill(mean_.begin(), mean_.end(), 0.0f);
    clamp(mean_.data());
    std::copy(mean_.begin(), mean_.end(), best_.begin());
    std::copy(first_variance_.begin(), first_variance_.end(), variance_.begin());
    kept_count_ = 0;
    result_ = {};
    bind_result();
  }

  void compute(const BatchEvaluator& evaluator, const SolveRequest& request,
               const Deadline& deadline) noexcept {
    if (options_.shift_warm_start) shift(warm_start_shift(evaluator, request));
    std::copy(first_variance_.begin(), first_variance_.end(), variance_.begin());

    detail::BatchStatistics statistics;
    Status status = Status::deadline;
    float best_cost = std::numeric_limits<float>::infinity();
    int iteration = 0;
    for (; iteration < options_.iterations && !deadline.passed(); ++iteration) {
      batch_.set_samples(sizes_[static_cast<std::size_t>(iteration)]);
      batch_.propose(iteration == 0 ? request.proposals : SequenceList{});
      statistics = sample(evaluator, iteration, deadline);
      result_.times.draw += statistics.draw_time;
      result_.times.evaluate += statistics.evaluate_time;
      status = statistics.finite == 0 ? Status::degenerate : Status::ok;
      if (status != Status::ok || statistics.evaluated == 0) break;
      refit(best_cost);
    }
    if (status == Status::ok && (iteration < options_.iterations || statistics.evaluated < batch_.samples()))
      status = Status::deadline;
    if (statistics.evaluated == 0) status = Status::deadline;
    if (status == Status::ok && statistics.collided == batch_.samples()) status = Status::all_collided;
    if (!(best_cost < std::numeric_limits<float>::infinity()))
      std::copy(mean_.begin(), mean_.end(), best_.begin());
    result_.status = status;
    result_.iterations = iteration;
    detail::report_samples(batch_, statistics, batch_.sum_weights(batch_.samples()), result_);
    next_solve();
  }

  /// Lets the result point to this solver's values.
  void bind_result() noexcept {
    result_.mean = mean_;
    result_.inputs = options_.send_best ? best_ : mean_;
    result_.nominal = zero_;
    result_.variances = variance_;
    if (result_.samples) detail::bind_samples(batch_, result_);
  }

 private:
  void shift(double steps) noexcept {
    if (!(steps > 0)) return;
    move_forward(mean_.data(), steps);
    for (int i = 0; i < kept_count_; ++i) move_forward(kept(i).data(), steps);
  }

  std::span<float> kept(int index) noexcept {
    return std::span(kept_).subspan(static_cast<std::size_t>(index) * size(), size());
  }

  /// Draws the samples of an iteration, replaces the last ones before the proposals by what is remembered,
  /// and evaluates all.
  detail::BatchStatistics sample(const BatchEvaluator& evaluator, int iteration,
                                 const Deadline& deadline) noexcept {
    for (std::size_t r = 0; r < size(); ++r) deviation_[r] = std::sqrt(variance_[r]);
    const detail::SamplingDistribution to{mean_.data(), deviation_.data(), low().data(), high().data(),
                                          zero_mean_from(batch_.samples(), options_.zero_mean_share)};
    const bool with_mean = memory_.add_mean && iteration + 1 == options_.iterations;
    if (with_mean) std::copy(mean_.begin(), mean_.end(), kept(kept_count_).begin());
    return batch_.draw_and_evaluate(evaluator, key(iteration), to, nullptr, pool(), deadline,
                                    {kept_, kept_count_ + with_mean});
  }

  /// Fits the distribution to the elites, which have equal weights.
  void refit(float& best_cost) noexcept {
    const auto begin = detail::Clock::now();
    const auto costs = batch_.costs();
    const auto order = std::span(order_).first(costs.size());
    std::iota(order.begin(), order.end(), 0);
    // The smaller index wins ties, so that the choice does not depend on the library's algorithm.
    const auto better = [&](int a, int b) { return costs[a] < costs[b] || (costs[a] == costs[b] && a < b); };
    std::nth_element(order.begin(), order.begin() + elites_ - 1, order.end(), better);
    std::fill_n(batch_.weights().data(), batch_.stride(), 0.0f);
    int used = 0, best = order[0];
    for (int i = 0; i < elites_; ++i) {
      const int k = order[i];
      if (std::isfinite(costs[k])) ++used;
      if (better(k, best)) best = k;
    }
    for (int i = 0; i < elites_; ++i) {
      const int k = order[i];
      if (std::isfinite(costs[k])) batch_.weights()[k] = 1.0f / used;
    }
    if (costs[best] < best_cost) {
      best_cost = costs[best];
      batch_.values().get_sample(best, best_);
    }
    batch_.weighted_sums(zero_.data(), sums_.data(), pool());
    std::copy(sums_.begin(), sums_.end(), elite_mean_.begin());
    batch_.weighted_squares(elite_mean_.data(), sums_.data(), pool());
    const float kept_share = static_cast<float>(options_.smoothing);
    for (std::size_t r = 0; r < size(); ++r) {
      const float least = std::min(min_variance_[r], first_variance_[r]);
      const float variance = static_cast<float>(sums_[r]);
      variance_[r] = std::clamp(variance + kept_share * (variance_[r] - variance), least, 1e30f);
      mean_[r] = elite_mean_[r] + kept_share * (mean_[r] - elite_mean_[r]);
    }
    clamp(mean_.data());
    kept_count_ = std::min(max_kept_, used);
    std::partial_sort(order.begin(), order.begin() + kept_count_, order.begin() + elites_, better);
    for (int i = 0; i < kept_count_; ++i) batch_.values().get_sample(order[i], kept(i));
    result_.times.update += detail::seconds(begin, detail::Clock::now());
  }

  const char* name_;
  CemOptions options_;
  Memory memory_;
  std::vector<int> sizes_;   ///< samples of each iteration
  detail::SampleSet batch_;  ///< samples of the last iteration made
  int elites_;
  int max_kept_;
  int kept_count_ = 0;
  std::vector<int> order_;
  std::vector<float> kept_;  ///< [elite][row], the best first, and room for the mean
  std::vector<float> mean_, variance_, first_variance_, min_variance_, deviation_, zero_, elite_mean_,
      best_;                  ///< [row]
  std::vector<double> sums_;  ///< [row]
};

}  // namespace

std::unique_ptr<Solver> make_solver(const CemOptions& options, int inputs, std::shared_ptr<ThreadPool> pool) {
  validate_options(options, CemOptions::method, inputs);
  return std::make_unique<CemSolver>(CemOptions::method, detail::with_variances(options, inputs), Memory{},
                                     inputs, std::move(pool));
}

std::unique_ptr<Solver> make_solver(const IcemOptions& o, int inputs, std::shared_ptr<ThreadPool> pool) {
  validate_options(o, IcemOptions::method, inputs);
  const auto options = shared_options<CemOptions>(o);
  const Memory memory{o.kept_elite_share, o.sample_decay, true};
  return std::make_unique<CemSolver>(IcemOptions::method, detail::with_variances(options, inputs), memory,
                                     inputs, std::move(pool));
}

}  // namespace slalom
