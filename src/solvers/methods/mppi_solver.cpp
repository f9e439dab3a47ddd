#include <algorithm>
#include <cmath>
#include <limits>

#include "slalom/solvers/mppi_options.hpp"
#include "solvers/methods/mppi_update.hpp"

namespace slalom {

namespace {

/// Most proposals that are evaluated at a time, and by one task.
constexpr int most_candidates = 1024, candidate_tile = 4 * simd::padding;

/// `mppi`: one closed-form update with zero as the nominal sequence, or with the best proposal.
class MppiSolver final : public SolverBase {
 public:
  MppiSolver(const MppiOptions& options, int inputs, std::shared_ptr<ThreadPool> pool)
      : SolverBase(options, inputs, std::move(pool)),
        shift_(options.shift_warm_start),
        update_(options, inputs),
        mean_(size()),
        shifted_(size()),
        nominal_(size()),
        variance_(spread(options.variance)) {
    if (options.nominal_from_proposals) {
      candidates_ = SequenceBatch(horizon(), inputs, most_candidates + 1);
      candidate_costs_ = AlignedBuffer(candidates_.stride());
      candidate_collided_.resize(static_cast<std::size_t>(candidates_.stride()));
    }
    reset(options.seed);
  }

  const char* name() const noexcept override { return MppiOptions::method; }
  std::unique_ptr<Solver> clone() const override {
    auto copy = std::make_unique<MppiSolver>(*this);
    copy->bind_result();
    return copy;
  }

  bool takes_proposals() const noexcept override { return true; }

  void reset(std::uint64_t seed) noexcept override {
    restart(seed);
    update_.reset();
    std::fill(mean_.begin(), mean_.end(), 0.0f);
    std::fill(nominal_.begin(), nominal_.end(), 0.0f);
    clamp(mean_.data());
    result_ = {};
    bind_result();
  }

  void prepare() noexcept override { update_.samples().prepare(key(0), pool()); }

  const SolveResult& solve(const BatchEvaluator& evaluator, const SolveRequest& request) noexcept override {
    const auto start = detail::Clock::now();
    const Deadline deadline(start, request.deadline);
    result_.times = {};
    const double shift = shift_ ? warm_start_shift(evaluator, request) : 0;
    if (shift > 0) {
      shift_sequence(mean_.data(), horizon(), inputs(), shift, shifted_.data());
      std::swap_ranges(mean_.begin(), mean_.end(), shifted_.begin());
    }
    if (candidates_.samples() > 0) {
      const auto ranked = detail::Clock::now();
      choose_nominal(evaluator, request.proposals, deadline.part(0.5));
      result_.times.guide = detail::seconds(ranked, detail::Clock::now());
    } else {
      update_.samples().propose(request.proposals);
    }
    result_.status = update_.update(evaluator, key(0), nominal_.data(), variance_.data(), low().data(),
                                    high().data(), pool(), deadline, mean_.data(), result_);
    result_.iterations = 1;
    next_solve();
    result_.times.total = detail::seconds(start, detail::Clock::now());
    return result_;
  }

 private:
  /// Lets the result point to this solver's values.
  void bind_result() noexcept {
    result_.inputs = result_.mean = mean_;
    result_.nominal = nominal_;
    result_.variances = variance_;
    if (result_.samples) detail::bind_samples(update_.samples(), result_);
  }

  /// Makes the best of the proposals and the last solution the mean of the samples and the nominal sequence.
  void choose_nominal(const BatchEvaluator& evaluator, const SequenceList& proposals,
                      const Deadline& deadline) noexcept {
    for (int next = 0; next < proposals.sequences && !deadline.passed();) {
      candidates_.set_sample(0, mean_);
      int count = 1;
      for (; count < candidates_.samples() && next < proposals.sequences; ++count, ++next)
        set_candidate(count, proposals.values.data() + static_cast<std::size_t>(next) * size());
      candidates_.get_sample(best_candidate(evaluator, count, deadline), mean_);
    }
    nominal_ = mean_;
  }

  /// The first of the `count` candidates of least cost; those that are not reached do not count.
  int best_candidate(const BatchEvaluator& evaluator, int count, const Deadline& deadline) noexcept {
    std::fill_n(candidate_costs_.data(), candidates_.stride(), std::numeric_limits<float>::infinity());
    const int tile = evaluator.whole_batches() ? count : candidate_tile;
    pool().run((count + tile - 1) / tile, [&](int t) {
      if (deadline.passed()) return;
      evaluator.evaluate(candidates_, t * tile, std::min(tile, count - t * tile), candidate_costs_.data(),
                         candidate_collided_.data());
    });
    int best = 0;
    for (int k = 1; k < count; ++k) {
      const float cost = candidate_costs_[k];
      if (std::isfinite(cost) && !(candidate_costs_[best] <= cost)) best = k;
    }
    return best;
  }

  /// A value that is not finite becomes that of the mean.
  void set_candidate(int k, const float* proposal) noexcept {
    for (std::size_t r = 0; r < size(); ++r)
      shifted_[r] = std::isfinite(proposal[r]) ? proposal[r] : mean_[r];
    clamp(shifted_.data());
    candidates_.set_sample(k, shifted_);
  }

  bool shift_;
  detail::MppiUpdate update_;
  std::vector<float> mean_, shifted_, nominal_, variance_;  ///< [row]
  SequenceBatch candidates_;  ///< proposals, after the best sequence so far; empty without the option
  AlignedBuffer candidate_costs_;
  std::vector<std::uint8_t> candidate_collided_;
};

}  // namespace

std::unique_ptr<Solver> make_solver(const MppiOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool) {
  validate_options(options, MppiOptions::method, inputs);
  return std::make_unique<MppiSolver>(options, inputs, std::move(pool));
}

}  // namespace slalom
