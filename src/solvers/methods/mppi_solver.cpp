#include <algorithm>
#include <cmath>
#include <limits>

#include "slalom/solvers/mppi_options.hpp"
#include "solvers/methods/mppi_update.hpp"

namespace slalom {

namespace {

/// `mppi`: one closed-form update with zero as the nominal sequence.
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
    update_.samples().propose(request.proposals);
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

  bool shift_;
  detail::MppiUpdate update_;
  std::vector<float> mean_, shifted_, nominal_, variance_;  ///< [row]
};

}  // namespace

std::unique_ptr<Solver> make_solver(const MppiOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool) {
  validate_options(options, MppiOptions::method, inputs);
  return std::make_unique<MppiSolver>(options, inputs, std::move(pool));
}

}  // namespace slalom
