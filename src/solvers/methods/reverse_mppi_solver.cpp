#include <algorithm>
#include <cmath>
#include <limits>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/solvers/default_variances.hpp"
#include "slalom/solvers/reverse_mppi_options.hpp"
#include "solvers/methods/method_solver.hpp"
#include "solvers/methods/mppi_update.hpp"
#include "solvers/methods/resampler.hpp"
#include "solvers/methods/reverse_weights.hpp"
#include "solvers/published/published_program.hpp"
#include "solvers/sampling/sample_set.hpp"

namespace slalom {

namespace {

/// A Gaussian over control sequences with independent entries [row].
struct Gaussian {
  std::vector<float> mean, variance;
};

/// `reverse_mppi` (Kobayashi and Fukumoto 2022): mirror descent on the reverse KL divergence. A second
/// distribution is fitted to bad samples, and fewer samples are drawn where its density is high.
class ReverseMppiSolver final : public detail::MethodSolver<ReverseMppiSolver> {
 public:
  ReverseMppiSolver(const ReverseMppiOptions& options, int inputs, std::shared_ptr<ThreadPool> pool)
      : MethodSolver(options, inputs, std::move(pool)),
        options_(options),
        samples_(options.horizon, inputs, options.samples),
        inflated_(
            options.horizon, inputs,
            std::max(options.samples, saturate_cast<int>(std::round(options.samples * options.inflation)))),
        first_variance_(spread(options.variance)),
        min_variance_(spread(options.variance_min)),
        deviation_(size()),
        linear_(size()),
        inverse_(size()),
        zero_(size()),
        last_mean_(size()),
        sums_(size() * detail::moments),
        moment_mean_(size()),
        moment_variance_(size()),
        rejection_(rows()),
        own_distance_(inflated_.stride()),
        rejected_distance_(own_distance_.size()),
        keep_(own_distance_.size()),
        resampler_(inflated_.samples(), options.samples),
        picked_(samples_.stride()),
        evaluated_(samples_.stride()),
        rejected_(evaluated_.size()) {
    for (Gaussian* g : {&now_, &now_rejected_, &start_, &start_rejected_}) {
      g->mean.resize(size());
      g->variance.resize(size());
    }
    reset(options.seed);
  }

  const char* name() const noexcept override { return ReverseMppiOptions::method; }

  void reset(std::uint64_t seed) noexcept override {
    restart(seed);
    for (Gaussian* g : {&now_, &now_rejected_, &start_, &start_rejected_}) {
      std::fill(g->mean.begin(), g->mean.end(), 0.0f);
      clamp(g->mean.data());
      std::copy(first_variance_.begin(), first_variance_.end(), g->variance.begin());
    }
    result_ = {};
    bind_result();
  }

  void compute(const BatchEvaluator& evaluator, const SolveRequest& request,
               const Deadline& deadline) noexcept {
    if (options_.shift_warm_start) shift(warm_start_shift(evaluator, request));
    now_ = start_;
    now_rejected_ = start_rejected_;

    detail::BatchStatistics statistics;
    Status status = Status::deadline;
    int iteration = 0;
    for (; iteration < options_.iterations && !deadline.passed(); ++iteration) {
      draw(iteration);
      statistics = evaluate(evaluator, deadline);
      if (statistics.evaluated < samples_.samples()) break;
      status = update(statistics) ? Status::ok : Status::degenerate;
      if (status != Status::ok) break;
    }
    if (status == Status::ok && iteration < options_.iterations) status = Status::deadline;
    if (status == Status::ok && statistics.collided == samples_.samples()) status = Status::all_collided;
    result_.status = status;
    result_.iterations = iteration;
    report(statistics);
    store();
    next_solve();
  }

  /// Lets the result point to this solver's values.
  void bind_result() noexcept {
    result_.inputs = result_.mean = now_.mean;
    result_.nominal = zero_;
    result_.variances = now_.variance;
    if (result_.samples) detail::bind_samples(samples_, result_);
  }

 private:
  void shift(double steps) noexcept {
    if (!(steps > 0)) return;
    for (Gaussian* g : {&start_, &start_rejected_})
      for (std::vector<float>* values : {&g->mean, &g->variance}) move_forward(values->data(), steps);
  }

  /// Draws the samples of an iteration, with rejection near bad samples if `reject_samples` is set.
  void draw(int iteration) noexcept {
    const auto begin = detail::Clock::now();
    for (std::size_t r = 0; r < size(); ++r) deviation_[r] = std::sqrt(now_.variance[r]);
    detail::SampleSet& set = options_.reject_samples ? inflated_ : samples_;
    set.draw(key(2 * iteration),
             {now_.mean.data(), deviation_.data(), low().data(), high().data(),
              zero_mean_from(set.samples(), options_.zero_mean_share)},
             pool());
    if (options_.reject_samples) {
      keep_probabilities();
      RandomStream random(key(2 * iteration + 1));
      resampler_.pick(keep_.data(), samples_.samples(), options_.resampling == Resampling::systematic, random,
                      picked_.data());
      detail::kernels::gather(inflated_.row_view(), picked_.data(), {0, samples_.stride()},
                              samples_.row_view());
    }
    result_.times.draw += detail::seconds(begin, detail::Clock::now());
  }

  /// Sets `keep_` to weights of the inflated samples, proportional to the probabilities of keeping them.
  void keep_probabilities() noexcept {
    const detail::Range range{0, inflated_.stride()};
    float* logarithms = own_distance_.data();
    if (options_.published.rejection == RejectionModel::published) {
      rejection_.set(now_.mean.data(), now_.variance.data(), now_rejected_.mean.data(),
                     now_rejected_.variance.data());
      detail::kernels::published_rejection(inflated_.row_view(), rejection_.rows(), range, logarithms);
    } else {
      const double own = distances(now_, own_distance_), other = distances(now_rejected_, rejected_distance_);
      detail::kernels::rejection_logarithm(rejected_distance_.data(), static_cast<float>(own - other), range,
                                           logarithms);
    }
    constexpr float infinite = std::numeric_limits<float>::infinity();
    std::fill(logarithms + inflated_.samples(), logarithms + range.count, infinite);
    detail::kernels::make_finite(range, logarithms);
    const float least = detail::kernels::minimum(logarithms, range);
    if (least < infinite) {
      detail::kernels::exponential_weights(logarithms, logarithms, least, 1.0f, range, keep_.data());
    } else {
      std::fill(keep_.begin(), keep_.end(), 1.0f);
    }
  }

  /// Sets `squared` to the sum of (v - mean)^2 / variance of each inflated sample. Returns the sum of the
  /// logarithms of the variances.
  double distances(const Gaussian& g, std::vector<float>& squared) noexcept {
    double logarithm = 0;
    for (std::size_t r = 0; r < size(); ++r) {
      const bool sampled = now_.variance[r] > 0 && now_rejected_.variance[r] > 0;
      inverse_[r] = sampled ? 1.0f / g.variance[r] : 0.0f;
      if (sampled) logarithm += std::log(static_cast<double>(g.variance[r]));
    }
    std::fill(squared.begin(), squared.end(), 0.0f);
    detail::kernels::add_squared_distance(inflated_.row_view(), g.mean.data(), inverse_.data(),
                                          {0, inflated_.stride()}, squared.data());
    return logarithm;
  }

  detail::BatchStatistics evaluate(const BatchEvaluator& evaluator, const Deadline& deadline) noexcept {
    detail::control_coefficients(options_.temperature, options_.control_cost_discount,
                                 options_.published.inverse_variance_offset, now_.mean.data(), zero_.data(),
                                 now_.variance.data(), rows(), linear_.data());
    const detail::BatchStatistics statistics = samples_.evaluate(evaluator, linear_.data(), pool(), deadline);
    result_.times.evaluate += statistics.evaluate_time;
    return statistics;
  }

  /// Updates both distributions. Returns false if no sample has a finite cost.
  bool update(const detail::BatchStatistics& statistics) noexcept {
    const auto begin = detail::Clock::now();
    if (statistics.finite == 0) return false;
    const detail::Range range{0, samples_.stride()};
    const detail::ReverseSums sums = detail::reverse_weights(
        samples_.totals().data(), static_cast<float>(options_.temperature),
        static_cast<float>(options_.negative_ratio), static_cast<float>(options_.published.normaliser_offset),
        range, evaluated_.data(), rejected_.data());
    if (!(sums.evaluated > 0)) {  // all costs are equal: no sample is better than another
      const float equal = 1.0f / statistics.finite;
      for (std::size_t k = 0; k < evaluated_.size(); ++k)
        evaluated_[k] = k < samples_.costs().size() && std::isfinite(samples_.totals()[k]) ? equal : 0.0f;
    }
    const Gaussian& before = now_;
    for (std::size_t r = 0; r < size(); ++r)
      inverse_[r] =
          detail::inverse_variance<float>(before.variance[r], options_.published.inverse_variance_offset);
    std::copy(before.mean.begin(), before.mean.end(), last_mean_.begin());
    samples_.two_moments(evaluated_.data(), rejected_.data(), last_mean_.data(), sums_.data(), pool());
    if (sums.rejected > 0) descend(2, now_rejected_);
    descend(0, now_);
    result_.times.update += detail::seconds(begin, detail::Clock::now());
    return true;
  }

  /// One step of mirror descent of a distribution towards the moments of weighted samples. `list` is the
  /// index of their first moment in `sums_`; the second is about the mean of the samples' distribution.
  void descend(std::size_t list, Gaussian& g) noexcept {
    for (std::size_t r = 0; r < size(); ++r) {
      const double scale = options_.published.dimensionless_variance ? inverse_[r] : 1.0;
      moment_mean_[r] = static_cast<float>(sums_[r * detail::moments + list]);
      moment_variance_[r] = static_cast<float>(sums_[r * detail::moments + list + 1] * scale);
    }
    detail::mirror_descent(static_cast<float>(options_.step), moment_mean_.data(), moment_variance_.data(),
                           rows(), g.mean.data(), g.variance.data());
    for (std::size_t r = 0; r < size(); ++r) {
      const float least = std::min(min_variance_[r], first_variance_[r]);
      g.variance[r] = std::clamp(g.variance[r], least, 1e12f);
      g.mean[r] = std::clamp(g.mean[r], -1e30f, 1e30f);
    }
  }

  void report(const detail::BatchStatistics& statistics) noexcept {
    std::copy_n(evaluated_.begin(), samples_.weights().size(), samples_.weights().begin());
    detail::report_samples(samples_, statistics, samples_.sum_weights(samples_.samples()), result_);
    result_.temperature = options_.temperature;
  }

  /// Mixes the new distributions into those from which the next solve starts, and clamps the solution.
  void store() noexcept {
    const float ratio = static_cast<float>(options_.warm_start);
    for (const auto& [from, to] : {std::pair{&now_, &start_}, std::pair{&now_rejected_, &start_rejected_}}) {
      detail::interpolate(to->mean.data(), from->mean.data(), ratio, rows(), to->mean.data());
      detail::interpolate(to->variance.data(), from->variance.data(), ratio, rows(), to->variance.data());
    }
    clamp(now_.mean.data());
  }

  ReverseMppiOptions options_;
  detail::SampleSet samples_, inflated_;
  Gaussian now_, now_rejected_, start_, start_rejected_;
  std::vector<float> first_variance_, min_variance_, deviation_, linear_, inverse_, zero_,
      last_mean_;                                     ///< [row]
  std::vector<double> sums_;                          ///< [row]
  std::vector<float> moment_mean_, moment_variance_;  ///< [row]
  detail::PublishedRejection rejection_;
  std::vector<float> own_distance_, rejected_distance_;  ///< [inflated sample]
  std::vector<float> keep_;                              ///< [inflated sample]
  detail::Resampler resampler_;
  std::vector<int> picked_;                  ///< [sample]
  std::vector<float> evaluated_, rejected_;  ///< weights [sample]
};

}  // namespace

std::unique_ptr<Solver> make_solver(const ReverseMppiOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool) {
  validate_options(options, ReverseMppiOptions::method, inputs);
  return std::make_unique<ReverseMppiSolver>(detail::with_variances(options, inputs), inputs,
                                             std::move(pool));
}

}  // namespace slalom
