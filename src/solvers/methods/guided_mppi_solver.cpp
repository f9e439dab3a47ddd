#include "solvers/methods/guided_mppi_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "solvers/methods/fine_noise.hpp"
#include "solvers/methods/guide_search.hpp"
#include "solvers/methods/last_choice.hpp"
#include "solvers/methods/method_solver.hpp"
#include "solvers/sampling/weigh_part.hpp"

namespace slalom {

namespace {

// The numbers were chosen on the seeds from 76000 of the problem suite.
constexpr int rollouts_of_guide = 100;    ///< a solve needs so many for each guide beyond the first
constexpr int many = 50;                  ///< samples of guides in a batch from which their means count
constexpr double least_of_guide = 0.125;  ///< share of either guide among their samples

/// `svg_mppi` in batches. Three things are kept apart: the *plan* p, which is the cheapest sequence known and
/// is returned; *guides*, which look for other ways; and *fine* samples, which make the plan exact. With z
/// from N(0, C), white or coloured, D0 the first deviations and v the samples of a batch:
///
///     guide   v = m + D z            (GuideSearch)
///     fine    v = p + a s e^x D0 z   (FineNoise)
///     plan    p <- the cheapest of p, all v, all m, the mean of the fine v, and the proposals
///
/// LastChoice ends a solve.
///
/// w are weights as in `mppi`, each kind's own. A guide's m is moved on from solve to solve and never
/// replaced by p, so it keeps looking elsewhere; its D starts anew in every solve. The second guide starts at
/// zero in every solve, with coloured noise alone; how many samples it gets follows from which guide has the
/// best one.
class GuidedMppiSolver final : public detail::MethodSolver<GuidedMppiSolver> {
 public:
  GuidedMppiSolver(const SvgMppiOptions& options, int batches, int inputs, std::shared_ptr<ThreadPool> pool)
      : MethodSolver(options, inputs, std::move(pool)),
        shift_(options.shift_warm_start),
        adapts_(options.adapt_covariance),
        apart_(options.guides.count > 0),
        zero_share_(options.zero_mean_share),
        given_temperature_(options.weighting.target_ess_fraction > 0 ? 0 : options.temperature),
        effective_fraction_(options.weighting.target_ess_fraction),
        guides_(static_cast<std::size_t>(
            std::clamp(std::min(options.guides.count, options.samples / rollouts_of_guide), 1, 2))),
        batches_(batches),
        total_(options.samples),
        set_(options.horizon, inputs, (total_ + batches - 1) / batches,
             detail::NoiseShape(options.noise, options.horizon, inputs)),
        first_variance_(spread(options.variance)),
        fine_(first_variance_),
        plan_(size()),
        zero_(size()),
        fine_mean_(size()),
        means_(guide_count(), rows()),
        known_(guide_count() + 2, rows()),
        path_(batches * guide_count(), rows()),
        sums_(size()),
        kinds_(set_.stride(), options.noise.knots == 0 && !options.noise.pinned),
        last_(options.horizon, inputs, guide_count() + 1, options.nearby_states) {
    for (detail::GuideSearch& guide : guides_) guide.variance = guide.deviation = first_variance_;
    set_.set_white(true);
    reset(options.seed);
  }

  static constexpr bool plan_is_cheapest = true;
  const char* name() const noexcept override { return SvgMppiOptions::method; }
  bool takes_proposals() const noexcept override { return true; }

  void reset(std::uint64_t seed) noexcept override {
    restart(seed);
    std::fill(plan_.begin(), plan_.end(), 0.0f);
    clamp(plan_.data());
    fine_mean_ = plan_;
    fine_.reset();
    for (int g = 0; g < guide_count(); ++g) {
      std::copy(plan_.begin(), plan_.end(), means_[g]);
      guide(g).reset();
    }
    fine_temperature_ = 0;
    second_share_ = 1.0 / 3;
    drawn_ = 0;
    result_ = {};
    bind_result();
  }

  void prepare() noexcept override { set_.prepare(key(0), pool()); }

  void compute(const BatchEvaluator& evaluator, const SolveRequest& request,
               const Deadline& deadline) noexcept {
    begin(shift_ ? warm_start_shift(evaluator, request) : 0, request.proposals);
    NearbyStates* const nearby = evaluator.whole_batches() ? nullptr : request.nearby;
    const bool ends = batches_ < total_ / 8;  // otherwise the rollouts of the end would be too many
    const int total = total_ - (ends ? last_.begin(plan_, nearby, total_) : 0);
    detail::BatchStatistics all;
    result_.status = Status::ok;
    int batch = 0;
    for (; batch < batches_ && result_.status == Status::ok; ++batch) {
      if (batch > 0 && deadline.passed()) {
        result_.status = Status::deadline;
        break;
      }
      set_.set_samples(total / batches_ + (batch < total % batches_));
      arrange();
      const detail::BatchStatistics drawn = set_.draw_and_evaluate(
          evaluator, key(batch), mixture(), {known_.values(), known_count_}, pool(), deadline);
      all += drawn;
      if (drawn.evaluated < set_.samples()) result_.status = Status::deadline;
      const auto start = detail::Clock::now();
      choose_plan(batch > 0);
      refine();
      for (int g = guide_count(); g-- > 0;) move(g, batch);  // the weights of the first one are reported
      ++drawn_;
      result_.times.update += detail::seconds(start, detail::Clock::now());
    }
    result_.iterations = batch;
    if (ends && result_.status == Status::ok) choose_last(evaluator);
    report(all);
    next_solve();
  }

  void bind_result() noexcept {
    result_.inputs = result_.mean = plan_;
    result_.nominal = {means_[0], size()};
    result_.variances = guides_[0].variance;
    result_.guides = {means_.values(), guide_count()};
    const int points = result_.iterations * guide_count();
    result_.guide_path = {
        std::span<const float>(path_.values()).first(static_cast<std::size_t>(points) * size()), points};
    if (result_.samples) detail::bind_samples(set_, result_);
  }

 private:
  static constexpr float infinite = std::numeric_limits<float>::infinity();

  int guide_count() const noexcept { return static_cast<int>(guides_.size()); }
  detail::GuideSearch& guide(int index) noexcept { return guides_[static_cast<std::size_t>(index)]; }

  /// Moves what is kept forward in time, and lists the sequences that are known.
  void begin(double steps, const SequenceList& proposals) noexcept {
    if (steps > 0) {
      move_forward(plan_.data(), steps);
      for (int g = 0; g < guide_count(); ++g) move_forward(means_[g], steps);
    }
    known_cost_ = infinite;
    known_count_ = 0;
    know(plan_.data());
    for (int g = 0; g < guide_count(); ++g) {
      guide(g).variance = first_variance_;
      if (!apart_) {
        std::copy(plan_.begin(), plan_.end(), means_[g]);
      } else if (g == 0) {
        know(means_[g]);
      } else {
        std::fill_n(means_[g], size(), 0.0f);
        clamp(means_[g]);
      }
    }
    set_.set_samples(set_.stride());
    set_.propose(proposals);
  }

  void know(const float* sequence) noexcept { std::copy_n(sequence, size(), known_[known_count_++]); }
  /// Divides the samples of a batch: the known sequences, proposals, fine samples, those of each guide.
  void arrange() noexcept {
    const int samples = set_.samples();
    known_count_ = std::min(known_count_, samples);
    fine_first_ = std::min(known_count_ + set_.proposed(), samples);
    const bool fine = adapts_ && drawn_ > 0;
    const int rest = samples - fine_first_;
    fine_end_ = fine_first_ + (fine ? saturate_cast<int>(std::round(detail::FineNoise::share * rest)) : 0);
    const int guided = samples - fine_end_;
    const int second = guide_count() > 1 ? saturate_cast<int>(std::round(second_share_ * guided)) : 0;
    guides_.back().end = samples;
    guides_.back().first = samples - second;
    guides_.front().first = fine_end_;
    guides_.front().end = samples - second;

    kinds_.mark(0, fine_first_, 0, 1, 0);
    kinds_.mark(fine_first_, fine_end_, 0, detail::FineNoise::white, drawn_);
    for (int k = fine_first_; k < fine_end_; ++k) kinds_.scale(k) = detail::FineNoise::spread(k + drawn_);
    for (int g = 0; g < guide_count(); ++g) {
      const detail::GuideSearch& own = guide(g);
      const int zeros = own.first + saturate_cast<int>(zero_share_ * (own.end - own.first));
      const double white = g == 0 ? own.white : 0;
      kinds_.mark(own.first, zeros, guide_count() + 1, white, drawn_);
      kinds_.mark(zeros, own.end, g + 1, white, drawn_);
    }
    kinds_.mark(samples, set_.stride(), 0, 1, 0);
  }

  /// The distributions of the samples: fine ones, those of each guide, and those around zero.
  detail::Mixture mixture() noexcept {
    std::size_t count = 0;
    sources_[count++] = {plan_.data(), fine_.deviation().data()};
    for (int g = 0; g < guide_count(); ++g) {
      sources_[count++] = {means_[g], guide(g).deviations()};
    }
    sources_[count++] = {zero_.data(), fine_.first_deviation().data()};
    return kinds_.of(std::span(sources_).first(count), low().data(), high().data());
  }

  /// The cheapest of the samples `first` to `end`, which are at least one.
  int best_of(int first, int end) const noexcept {
    const float* const costs = set_.costs().data();
    return static_cast<int>(std::min_element(costs + first, costs + end) - costs);
  }

  /// Whether the guides' means are nearly as cheap as their best samples: they are then plans in their place,
  /// since they keep farther from obstacles.
  bool has_many_samples() const noexcept { return set_.samples() - fine_end_ >= many; }

  /// Makes the cheapest sequence the plan. After the first batch, the mean of the last fine samples is known.
  void choose_plan(bool knows_fine_mean) noexcept {
    fine_won_ = fine_first_ > 0 && take(best_of(0, fine_first_)) && knows_fine_mean;
    if (fine_end_ < set_.samples() && !has_many_samples()) take(best_of(fine_end_, set_.samples()));
    if (fine_first_ < fine_end_ && take(best_of(fine_first_, fine_end_))) fine_won_ = true;
    const detail::GuideSearch &a = guides_.front(), &b = guides_.back();
    if (guide_count() > 1 && a.has_samples() && b.has_samples())
      detail::learn_share(second_share_,
                          set_.costs()[best_of(b.first, b.end)] < set_.costs()[best_of(a.first, a.end)],
                          least_of_guide);
    set_.propose({});
    known_count_ = 0;
  }

  /// Makes a sample the plan if it costs less, and returns whether it does.
  bool take(int sample) noexcept {
    if (!(set_.costs()[sample] < known_cost_)) return false;
    known_cost_ = set_.costs()[sample];
    set_.values().get_sample(sample, plan_);
    return true;
  }

  /// The weighted mean of the samples, within the bounds.
  void mean_of_samples(float* mean) noexcept {
    set_.weighted_sums(zero_.data(), sums_.data(), pool());
    std::copy(sums_.begin(), sums_.end(), mean);
    clamp(mean);
  }

  /// Fits the fine noise. The mean of the fine samples is known in the next batch.
  void refine() noexcept {
    const double samples = fine_end_ - fine_first_;
    if (samples > 0) fine_.learn_scale(fine_won_);
    if (!(weigh_part(set_, fine_first_, fine_end_, std::sqrt(samples), 0, fine_temperature_).weight > 0)) {
      fine_mean_ = plan_;
      return;
    }
    mean_of_samples(fine_mean_.data());
    know(fine_mean_.data());
    set_.weighted_squares(fine_mean_.data(), sums_.data(), pool());
    fine_.learn_shape(sums_);
  }

  /// Moves a guide to the weighted mean of its samples, and its variance towards theirs.
  void move(int index, int batch) noexcept {
    detail::GuideSearch& own = guide(index);
    const int samples = own.end - own.first;
    const double effective = effective_fraction_ > 0
                                 ? effective_fraction_ * samples
                                 : detail::GuideSearch::effective_share * std::sqrt(samples);
    weight_sums_ = weigh_part(set_, own.first, own.end, effective, given_temperature_, own.temperature);
    if (weight_sums_.weight > 0) {
      own.learn_colour(kinds_.white(best_of(own.first, own.end)));
      mean_of_samples(means_[index]);
      effective_size_ += weight_sums_.effective();
      if (has_many_samples()) know(means_[index]);
      if (adapts_) {
        set_.weighted_squares(means_[index], sums_.data(), pool());
        own.narrow(sums_, first_variance_);
      }
    }
    std::copy_n(means_[index], size(), path_[batch * guide_count() + index]);
  }

  /// Makes the best of the last sequences the plan.
  void choose_last(const BatchEvaluator& evaluator) noexcept {
    last_.clear(plan_);
    last_.add(fine_mean_);
    for (int g = 0; g < guide_count(); ++g) last_.add({means_[g], size()});
    last_.compare(
        [&] { (void)evaluate(evaluator, last_.sequences, {}, last_.costs.data(), last_.collided.data()); });
    known_cost_ = last_.choose(known_cost_, plan_);
  }

  void report(const detail::BatchStatistics& all) noexcept {
    detail::report_samples(set_, all, weight_sums_, result_);
    result_.times.draw = all.draw_time;
    result_.times.evaluate = all.evaluate_time;
    result_.minimum_cost = known_cost_;
    result_.effective_sample_size = effective_size_;
    effective_size_ = 0;
    result_.temperature = guides_[0].temperature;
    if (all.finite == 0 && result_.status == Status::ok) result_.status = Status::degenerate;
    if (all.collided == all.evaluated && result_.status == Status::ok) result_.status = Status::all_collided;
    bind_result();
  }

  bool shift_, adapts_;
  bool apart_;  ///< whether guides are kept apart from the plan
  double zero_share_, given_temperature_, effective_fraction_;
  std::vector<detail::GuideSearch> guides_;
  int batches_;
  int total_;  ///< rollouts of a solve
  detail::SampleSet set_;
  std::vector<float> first_variance_;  ///< [row]
  detail::FineNoise fine_;
  std::vector<float> plan_, zero_, fine_mean_;  ///< [row]
  detail::Matrix<float> means_;                 ///< [guide][row]
  detail::Matrix<float> known_;                 ///< [known sequence][row]
  detail::Matrix<float> path_;                  ///< [batch x guide][row]
  std::vector<double> sums_;                    ///< [row]
  detail::SampleKinds kinds_;
  detail::LastChoice last_;
  std::array<detail::Mixture::Source, 4> sources_;
  detail::WeightSums<double> weight_sums_;  ///< sums of the present weights, before they were normalised
  double fine_temperature_ = 0;
  double second_share_ = 0;      ///< share of the second guide among the guides' samples
  double effective_size_ = 0;    ///< summed over the guides and batches of the present solve
  float known_cost_ = infinite;  ///< cost of the plan
  int known_count_ = 0, fine_first_ = 0, fine_end_ = 0;
  std::int64_t drawn_ = 0;  ///< batches since the last reset
  bool fine_won_ = false;   ///< whether a fine sample improved the plan
};

}  // namespace

namespace detail {

std::unique_ptr<Solver> make_guided_mppi(const SvgMppiOptions& options, int batches, int inputs,
                                         std::shared_ptr<ThreadPool> pool) {
  return std::make_unique<GuidedMppiSolver>(options, batches, inputs, std::move(pool));
}

}  // namespace detail

}  // namespace slalom
