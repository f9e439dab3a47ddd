#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "slalom/solvers/default_variances.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"
#include "solvers/methods/guides.hpp"
#include "solvers/methods/method_solver.hpp"
#include "solvers/methods/mppi_update.hpp"
#include "solvers/sampling/seek_temperature.hpp"

namespace slalom {

namespace {

/// `svg_mppi` (Honda et al., "Stein Variational Guided Model Predictive Path Integral Control", ICRA 2024):
/// guides lead the closed form of MPPI to one mode. If the samples are drawn around the nominal sequence, the
/// control term of equation (8) is zero. They are then drawn in several batches, as in `icem` (Pinneri et al.
/// 2020): each has the mean and the variance of the weighted samples of the last one, and contains that mean
/// and the best sequence so far; the first batch contains the elites of the last solve. The first and the
/// last two batches have white noise, those between coloured noise: some problems need inputs that change
/// slowly, others inputs that change from step to step. The best sequence or the last mean, whichever costs
/// less, is the solution.
class SvgMppiSolver final : public detail::MethodSolver<SvgMppiSolver> {
 public:
  /// `options` has the size of the largest batch in place of the number of all samples, `total`.
  SvgMppiSolver(const SvgMppiOptions& options, int total, int inputs, std::shared_ptr<ThreadPool> pool)
      : MethodSolver(options, inputs, std::move(pool)),
        shift_(options.shift_warm_start),
        use_nominal_(options.use_nominal),
        around_nominal_(options.use_nominal && options.guides.sample_around == SampleCentre::nominal),
        adapt_covariance_(options.adapt_covariance),
        white_batches_(options.batches > 1 && options.noise.knots == 0 && !options.noise.pinned),
        total_(total),
        batches_(options.batches),
        guides_(options, inputs, low(), high()),
        update_(options, inputs),
        mean_(size()),
        proposal_(size()),
        nominal_(size()),
        order_(options.samples),
        kept_((most_elites + 1) * size()),
        squares_(size()),
        variance_(spread(options.variance)),
        fixed_variance_(variance_) {
    update_.samples().set_white(white_batches_);
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
    elites_ = 0;
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
    if (batches_ > 1) {
      draw_batches(evaluator, deadline);
    } else {
      result_.status = update(evaluator, nominal_.data(), samples, deadline);
    }
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
  static constexpr int most_elites = 4;  ///< sequences that are kept from one solve to the next
  /// The random streams of a solve.
  enum Stage { first_guides, samples, gradients, later_batches = 60000, restarts = 65535 };

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

  Status update(const BatchEvaluator& evaluator, const float* nominal, int stage,
                const Deadline& deadline) noexcept {
    const auto drawn = update_.sample(evaluator, key(stage),
                                      {mean_.data(), nominal, variance_.data(), low().data(), high().data()},
                                      pool(), deadline);
    const Status status = update_.move_mean(drawn, pool(), mean_.data(), result_);
    if (drawn.finite > 0) clamp(mean_.data());
    return status;
  }

  /// Makes one update for each batch, then replaces the mean by the best sequence if that costs less.
  void draw_batches(const BatchEvaluator& evaluator, const Deadline& deadline) noexcept {
    detail::SampleSet& set = update_.samples();
    float least = std::numeric_limits<float>::infinity();
    for (int batch = 0; batch < batches_; ++batch) {
      if (batch > 0 && deadline.passed()) {
        result_.status = Status::deadline;
        break;
      }
      set.set_samples(total_ / batches_ + (batch < total_ % batches_));
      set.set_white(white_batches_ && (batch == 0 || batch >= batches_ - 2));
      if (batch > 0) elites_ = std::min(elites_, 1);  // more of them would narrow the samples too soon
      std::copy(mean_.begin(), mean_.end(), kept(elites_));
      const int count = std::min(elites_ + 1, set.samples() / 4);
      set.propose({std::span(kept_).first(count * size()), count});
      result_.status = update(evaluator, mean_.data(), batch > 0 ? later_batches + batch : samples, deadline);
      const float best = keep_elites(set, least);
      if (!(best < std::numeric_limits<float>::infinity())) break;
      least = std::min(least, best);
      if (result_.status == Status::deadline) break;
      if (batch + 1 < batches_) narrow_variance(set);
    }
    set.set_white(white_batches_);  // the noise of the next first batch may be drawn before the next solve
    if (elites_ > 0 && !(guides_.cost(evaluator, mean_.data()) <= least))
      std::copy_n(kept(0), size(), mean_.data());
  }

  /// Keeps the samples of least cost, unless that is above `least`. Returns the least cost.
  float keep_elites(const detail::SampleSet& set, float least) noexcept {
    const std::span<const float> costs = set.costs();
    const auto order = std::span(order_).first(costs.size());
    std::iota(order.begin(), order.end(), 0);
    const auto better = [&](int a, int b) { return costs[a] < costs[b] || (costs[a] == costs[b] && a < b); };
    const int most = std::min(most_elites, set.samples());
    std::partial_sort(order.begin(), order.begin() + most, order.end(), better);
    const float best = costs[order[0]];
    if (best > least) return best;
    for (elites_ = 0; elites_ < most && costs[order[elites_]] < std::numeric_limits<float>::infinity();
         ++elites_)
      set.values().get_sample(order[elites_], std::span(kept_).subspan(elites_ * size(), size()));
    return best;
  }

  /// Moves the variance to that of the weighted samples.
  void narrow_variance(detail::SampleSet& set) noexcept {
    constexpr float kept_share = 0.1f, least_share = 1e-4f;
    set.weighted_squares(mean_.data(), squares_.data(), pool());
    for (std::size_t r = 0; r < size(); ++r) {
      const float found = static_cast<float>(squares_[r]);
      variance_[r] = std::max(found + kept_share * (variance_[r] - found), least_share * fixed_variance_[r]);
    }
  }

  /// A kept sequence: the elites, the best first, then the mean.
  float* kept(int index) noexcept { return kept_.data() + static_cast<std::size_t>(index) * size(); }

  void shift(double steps) noexcept {
    if (!(steps > 0)) return;
    move_forward(mean_.data(), steps);
    move_forward(nominal_.data(), steps);
    for (int i = 0; i < elites_; ++i) move_forward(kept(i), steps);
    guides_.shift(steps);
  }

  bool shift_, use_nominal_, around_nominal_, adapt_covariance_, white_batches_;
  int total_, batches_;
  int elites_ = 0;  ///< number of elites
  detail::Guides guides_;
  detail::MppiUpdate update_;
  std::vector<float> mean_, proposal_, nominal_;  ///< [row]
  std::vector<int> order_;                        ///< sample indices, by cost
  std::vector<float> kept_;                       ///< [most_elites + 1][row]
  std::vector<double> squares_;                   ///< [row]
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
  const bool one = !o.use_nominal || o.guides.sample_around == SampleCentre::solution;
  const int total = o.samples;
  const int wanted = o.batches > 0 ? o.batches : std::clamp(total / 40, 4, 8);
  o.batches = one ? 1 : std::min(wanted, total);
  o.samples = (total + o.batches - 1) / o.batches;
  if (o.batches > 1 && o.temperature == 0 && o.weighting.target_ess_fraction == 0)
    o.weighting.target_ess_fraction = detail::default_effective_size(o.samples, true) / o.samples;
  return std::make_unique<SvgMppiSolver>(o, total, inputs, std::move(pool));
}

}  // namespace slalom
