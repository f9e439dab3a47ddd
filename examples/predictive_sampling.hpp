#pragma once

// A method of one's own: predictive sampling (Howell et al., "Predictive Sampling", 2022). Of many disturbed
// copies of the last plan the best is the next plan.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <vector>

#include <slalom/solvers/option_groups.hpp>
#include <slalom/solvers/solver_base.hpp>

/// The options of the method. `visit_options` below describes the fields for configurations, command line and
/// Python.
struct PredictiveSamplingOptions {
  static constexpr const char* method = "predictive_sampling";

  int horizon = 20;
  int samples = 512;
  slalom::PerInput variance = 1;
  slalom::PerInput input_min = -std::numeric_limits<double>::infinity();
  slalom::PerInput input_max = std::numeric_limits<double>::infinity();
  std::uint64_t seed = 0;
  int threads = 1;
};

template <class Options, class Visit>
requires slalom::is_options_of<Options, PredictiveSamplingOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.horizon, {"horizon", "steps", "inputs of a plan", 1, 10000});
  visit(o.samples, {"samples", "", "disturbed plans; the first is the last plan itself", 1, 4194304});
  visit(o.variance, {"variance", "input^2", "variance of the disturbances", 0, 1e12});
  visit(o.input_min, {"input_min", "input", "lower bound of the inputs"});
  visit(o.input_max, {"input_max", "input", "upper bound of the inputs"});
  slalom::visit_run_options(o, visit);  // seed and threads
}

/// The method: shift, disturb, evaluate, take the best.
class PredictiveSampling final : public slalom::SolverBase {
 public:
  PredictiveSampling(const PredictiveSamplingOptions& options, int inputs,
                     std::shared_ptr<slalom::ThreadPool> pool)
      : SolverBase(options, inputs, std::move(pool)),
        batch_(options.horizon, inputs, options.samples),
        costs_(batch_.stride()),
        collided_(static_cast<std::size_t>(batch_.stride())),
        plan_(size()),
        deviation_(spread(options.variance)) {
    for (float& d : deviation_) d = std::sqrt(d);
    PredictiveSampling::reset(options.seed);
  }
  const char* name() const noexcept override { return PredictiveSamplingOptions::method; }
  std::unique_ptr<slalom::Solver> clone() const override {
    auto copy = std::make_unique<PredictiveSampling>(*this);
    copy->result_.inputs = copy->result_.mean = copy->plan_;
    return copy;
  }

  void reset(std::uint64_t seed) noexcept override {
    restart(seed);
    std::fill(plan_.begin(), plan_.end(), 0.0f);
    clamp(plan_.data());
    result_ = {};
    result_.inputs = result_.mean = plan_;
  }

  const slalom::SolveResult& solve(const slalom::BatchEvaluator& evaluator,
                                   const slalom::SolveRequest& request) noexcept override {
    const auto start = slalom::Deadline::Clock::now();
    const slalom::Deadline deadline(start, request.deadline);
    move_forward(plan_.data(), slalom::warm_start_shift(evaluator, request));  // holds the last input

    slalom::fill_normal(batch_, 0, batch_.stride(), key(0));
    next_solve();
    for (int r = 0; r < rows(); ++r) {
      float* row = batch_.data(r);
      row[0] = plan_[r];
      for (int k = 1; k < batch_.stride(); ++k)
        row[k] = std::clamp(plan_[r] + deviation_[r] * row[k], low()[r], high()[r]);
    }
    const slalom::BatchOutcome outcome =
        evaluate(evaluator, batch_, deadline, costs_.data(), collided_.data());
    if (outcome.finite > 0) batch_.get_sample(outcome.best, plan_);  // otherwise the last plan, shifted
    result_.status = outcome.status();
    result_.minimum_cost = static_cast<double>(costs_[outcome.best]);
    result_.times.total = std::chrono::duration<double>(slalom::Deadline::Clock::now() - start).count();
    return result_;
  }

 private:
  slalom::SequenceBatch batch_;
  slalom::AlignedBuffer costs_;
  std::vector<std::uint8_t> collided_;
  std::vector<float> plan_, deviation_;  // [step][input]
};

inline std::unique_ptr<slalom::Solver> make_solver(const PredictiveSamplingOptions& options, int inputs,
                                                   std::shared_ptr<slalom::ThreadPool> pool = nullptr) {
  slalom::validate_options(options, PredictiveSamplingOptions::method, inputs);
  return std::make_unique<PredictiveSampling>(options, inputs, std::move(pool));
}
