#include <algorithm>
#include <cmath>

#include "slalom/core/option_access.hpp"
#include "slalom/solvers/default_variances.hpp"
#include "slalom/solvers/dial_mpc_options.hpp"
#include "slalom/solvers/mppi_options.hpp"
#include "solvers/methods/method_solver.hpp"
#include "solvers/methods/mppi_update.hpp"

namespace slalom {

namespace {

/// The additions of `dial_mpc` to `mppi`; none with these defaults.
struct Annealing {
  int iterations = 1;          ///< updates in a solve
  int first_iterations = 1;    ///< updates in the first solve
  double iteration_decay = 1;  ///< factor of the standard deviations from one update to the next
  double horizon_decay = 1;    ///< factor of the standard deviations from the last step to the first
};

/// `mppi`: a closed-form update with zero as the nominal sequence. With `Annealing` it is `dial_mpc` (Xue et
/// al. 2024, algorithm 1): several updates, with less noise in each.
class MppiSolver final : public detail::MethodSolver<MppiSolver> {
 public:
  MppiSolver(const char* name, const MppiOptions& options, const Annealing& annealing, int inputs,
             std::shared_ptr<ThreadPool> pool)
      : MethodSolver(options, inputs, std::move(pool)),
        name_(name),
        annealing_(annealing),
        shift_(options.shift_warm_start),
        update_(options, inputs),
        mean_(size()),
        zero_(size()),
        first_variance_(spread(options.variance)),
        variance_(size()) {
    // The inputs at the start of the horizon were refined in the most solves, so they get the least noise.
    for (std::size_t r = 0; r < size(); ++r) {
      const std::size_t step = r / static_cast<std::size_t>(inputs);
      const double from_end = horizon() > 1 ? 1 - static_cast<double>(step) / (horizon() - 1) : 0;
      first_variance_[r] *= static_cast<float>(std::pow(annealing.horizon_decay, 2 * from_end));
    }
    reset(options.seed);
  }

  const char* name() const noexcept override { return name_; }

  bool takes_proposals() const noexcept override { return true; }

  void reset(std::uint64_t seed) noexcept override {
    restart(seed);
    update_.reset();
    has_solution_ = false;
    std::fill(mean_.begin(), mean_.end(), 0.0f);
    clamp(mean_.data());
    std::copy(first_variance_.begin(), first_variance_.end(), variance_.begin());
    result_ = {};
    bind_result();
  }

  void prepare() noexcept override { update_.samples().prepare(key(0), pool()); }

  void compute(const BatchEvaluator& evaluator, const SolveRequest& request,
               const Deadline& deadline) noexcept {
    const double shift = shift_ ? warm_start_shift(evaluator, request) : 0;
    if (shift > 0) move_forward(mean_.data(), shift);
    update_.samples().propose(request.proposals);
    make_updates(evaluator, deadline);
    next_solve();
  }

  /// Points the spans of the result to this solver's values.
  void bind_result() noexcept {
    result_.inputs = result_.mean = mean_;
    result_.nominal = zero_;
    result_.variances = variance_;
    if (result_.samples) detail::bind_samples(update_.samples(), result_);
  }

 private:
  void make_updates(const BatchEvaluator& evaluator, const Deadline& deadline) noexcept {
    const int wanted = has_solution_ ? annealing_.iterations : annealing_.first_iterations;
    double scale = 1;
    result_.iterations = 0;
    for (int i = 0; i < wanted; ++i, scale *= annealing_.iteration_decay * annealing_.iteration_decay) {
      for (std::size_t r = 0; r < size(); ++r) variance_[r] = static_cast<float>(scale * first_variance_[r]);
      const auto drawn = update_.sample(
          evaluator, key(i), {mean_.data(), zero_.data(), variance_.data(), low().data(), high().data()},
          pool(), deadline);
      result_.status = update_.move_mean(drawn, pool(), mean_.data(), result_, update_.samples().proposed());
      if (drawn.finite > 0) clamp(mean_.data());
      if (result_.status == Status::deadline || result_.status == Status::degenerate) return;
      has_solution_ = true;
      result_.iterations = i + 1;
    }
  }

  const char* name_;
  Annealing annealing_;
  bool shift_;
  detail::MppiUpdate update_;
  std::vector<float> mean_, zero_, first_variance_, variance_;  ///< [row]
  bool has_solution_ = false;
};

}  // namespace

std::unique_ptr<Solver> make_solver(const MppiOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool) {
  validate_options(options, MppiOptions::method, inputs);
  return std::make_unique<MppiSolver>(MppiOptions::method, detail::with_variances(options, inputs),
                                      Annealing{}, inputs, std::move(pool));
}

std::unique_ptr<Solver> make_solver(const DialMpcOptions& o, int inputs, std::shared_ptr<ThreadPool> pool) {
  validate_options(o, DialMpcOptions::method, inputs);
  auto options = shared_options<MppiOptions>(o);
  options.samples = std::max(o.samples / o.iterations, 1);
  options.control_cost_discount = 1;  // no control term
  const Annealing annealing{o.iterations, o.first_iterations, o.iteration_decay, o.horizon_decay};
  return std::make_unique<MppiSolver>(DialMpcOptions::method, detail::with_variances(options, inputs),
                                      annealing, inputs, std::move(pool));
}

}  // namespace slalom
