#include <algorithm>
#include <atomic>
#include <cmath>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/solvers/default_variances.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"
#include "solvers/methods/guided_mppi_solver.hpp"
#include "solvers/methods/guides.hpp"
#include "solvers/methods/method_solver.hpp"
#include "solvers/methods/mppi_update.hpp"

namespace slalom {

namespace {

/// The closed form of `svg_mppi` (Honda et al., "Stein Variational Guided Model Predictive Path Integral
/// Control", ICRA 2024): guides lead the update of MPPI to one mode. If the samples are drawn around the
/// nominal sequence, the control term of equation (8) is zero.
class SvgMppiSolver final : public detail::MethodSolver<SvgMppiSolver> {
 public:
  SvgMppiSolver(const SvgMppiOptions& options, int inputs, std::shared_ptr<ThreadPool> pool)
      : MethodSolver(options, inputs, std::move(pool)),
        shift_(options.shift_warm_start),
        use_nominal_(options.use_nominal),
        around_nominal_(options.use_nominal && options.guides.sample_around == SampleCentre::nominal),
        adapt_covariance_(options.adapt_covariance),
        guides_(options, inputs, low(), high()),
        update_(options, inputs),
        mean_(size()),
        proposal_(size()),
        nominal_(size()),
        variance_(spread(options.variance)),
        fixed_variance_(variance_) {
    reset(options.seed);
  }

  const char* name() const noexcept override { return SvgMppiOptions::method; }

  bool takes_proposals() const noexcept override { return true; }

  void reset(std::uint64_t seed) noexcept override {
    restart(seed);
    update_.reset();
    guides_.restart(key(first_guides));
    std::fill(mean_.begin(), mean_.end(), 0.0f);
    std::fill(nominal_.begin(), nominal_.end(), 0.0f);
    clamp(mean_.data());
    variance_ = fixed_variance_;
    result_ = {};
    bind_result();
  }

  void prepare() noexcept override { update_.samples().prepare(key(samples), pool()); }

  void compute(const BatchEvaluator& evaluator, const SolveRequest& request,
               const Deadline& deadline) noexcept {
    const auto start = detail::Clock::now();
    if (shift_) shift(warm_start_shift(evaluator, request));

    // (a) Guides move to modes (equations (9) to (11)); the last solution and proposals may join them.
    if (around_nominal_) guides_.take_in(evaluator, mean_.data());
    take_in(evaluator, request.proposals);
    guides_.restart_others(key(restarts));
    move_guides(evaluator, deadline);
    // (b) The best guide is the nominal sequence (equation (12)).
    if (use_nominal_ && guides_.best_cost() < std::numeric_limits<float>::infinity()) {
      std::copy_n(guides_.best_sequence().data(), size(), nominal_.data());
    } else if (around_nominal_) {
      nominal_ = mean_;
    }
    if (around_nominal_) mean_ = nominal_;
    // (c) The variances are fitted to the path of the best guide (equation (13)).
    variance_ = fixed_variance_;
    if (adapt_covariance_) guides_.fit_variance(update_.temperature(), variance_.data());
    result_.times.guide = detail::seconds(start, detail::Clock::now());

    // (d) MPPI with that nominal sequence and those variances (equations (7) and (8)).
    result_.status = update(evaluator, nominal_.data(), deadline);
    result_.guides = guides_.sequences();
    result_.guide_path = guides_.path();
    next_solve();
  }

  /// Points the spans of the result to this solver's values.
  void bind_result() noexcept {
    result_.inputs = result_.mean = mean_;
    result_.nominal = nominal_;
    result_.variances = variance_;
    if (!result_.samples) return;
    detail::bind_samples(update_.samples(), result_);
    result_.guides = guides_.sequences();
    result_.guide_path = guides_.path();
  }

 private:
  /// The random streams of a solve.
  enum Stage { first_guides, samples, gradients, restarts = 65535 };

  /// Offers proposals as guides; without a nominal sequence, as samples.
  void take_in(const BatchEvaluator& evaluator, const SequenceList& proposals) noexcept {
    update_.samples().propose(use_nominal_ ? SequenceList{} : proposals);
    if (!use_nominal_) return;
    for (int i = 0; i < proposals.sequences; ++i) {
      const float* const proposal = proposals.values.data() + static_cast<std::size_t>(i) * size();
      for (std::size_t r = 0; r < size(); ++r)
        proposal_[r] = std::isfinite(proposal[r]) ? proposal[r] : mean_[r];
      clamp(proposal_.data());
      guides_.take_in(evaluator, proposal_.data());
    }
  }

  /// Moves the guides, each share on one thread. Threads without a share draw the noise of the samples
  /// meanwhile, but not that of the first tiles, which the calling thread will evaluate: those would have to
  /// move between caches.
  void move_guides(const BatchEvaluator& evaluator, const Deadline& deadline) noexcept {
    detail::SampleSet& set = update_.samples();
    const int threads = pool().threads();
    const int shares = threads > 1 && !evaluator.whole_batches() ? guides_.sequences().sequences : 1;
    const bool draws = threads > 1 && set.lacks_noise(evaluator, key(samples));
    const int first = set.tiles() / threads, tiles = draws ? set.tiles() - first : 0;
    const Deadline half = deadline.part(0.5);  // guides without samples would give no solution
    if (draws) set.begin_prepare(key(samples));
    guides_.begin_move(mean_.data(), nominal_.data(), shares);
    std::atomic<int> moving{shares};
    pool().run(shares + tiles, [&](int task) {
      if (task < shares) {
        guides_.move_share(task, evaluator, key(gradients), half);
        moving.fetch_sub(1, std::memory_order_relaxed);
      } else if (moving.load(std::memory_order_relaxed) > 0) {
        set.prepare_tile(first + task - shares, key(samples));
      }
    });
    result_.iterations = guides_.end_move(evaluator);
  }

  Status update(const BatchEvaluator& evaluator, const float* nominal, const Deadline& deadline) noexcept {
    const auto drawn = update_.sample(evaluator, key(samples),
                                      {mean_.data(), nominal, variance_.data(), low().data(), high().data()},
                                      pool(), deadline);
    const Status status = update_.move_mean(drawn, pool(), mean_.data(), result_);
    if (drawn.finite > 0) clamp(mean_.data());
    return status;
  }

  void shift(double steps) noexcept {
    if (!(steps > 0)) return;
    move_forward(mean_.data(), steps);
    move_forward(nominal_.data(), steps);
    guides_.shift(steps);
  }

  bool shift_, use_nominal_, around_nominal_, adapt_covariance_;
  detail::Guides guides_;
  detail::MppiUpdate update_;
  std::vector<float> mean_, proposal_, nominal_;  ///< [row]
  std::vector<float> variance_, fixed_variance_;  ///< [row]
};

}  // namespace

std::unique_ptr<Solver> make_solver(const SvgMppiOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool) {
  validate_options(options, SvgMppiOptions::method, inputs);
  SvgMppiOptions o = detail::with_guide_variances(options, inputs);
  if (o.guides.weight != GuideWeight::state_cost && o.guides.gradient_temperature == 0)
    throw std::invalid_argument(
        "svg_mppi.gradient_temperature: 0 must be above 0 unless guide_weight is state_cost");
  if (o.batches != 1 && o.use_nominal && o.guides.sample_around == SampleCentre::nominal) {
    const int usual = saturate_cast<int>(std::round(0.75 * std::cbrt(o.samples)));
    const int batches = o.batches > 0 ? o.batches : std::clamp(usual, 1, 8);
    return detail::make_guided_mppi(o, std::min(batches, o.samples), inputs, std::move(pool));
  }
  if (o.guides.count < 1)
    throw std::invalid_argument("svg_mppi.guides: 0 must be at least 1 in the closed form (one batch)");
  return std::make_unique<SvgMppiSolver>(o, inputs, std::move(pool));
}

}  // namespace slalom
