#pragma once

#include <algorithm>
#include <atomic>
#include <memory>

#include "slalom/solvers/solver_base.hpp"
#include "solvers/sampling/sample_set.hpp"

namespace slalom::detail {

/// An evaluator that counts the sequences it evaluates.
class CountingEvaluator final : public BatchEvaluator {
 public:
  explicit CountingEvaluator(const BatchEvaluator& evaluator) : evaluator_(evaluator) {}

  int count() const noexcept { return count_; }
  int inputs() const noexcept override { return evaluator_.inputs(); }
  double time_step() const noexcept override { return evaluator_.time_step(); }
  bool whole_batches() const noexcept override { return evaluator_.whole_batches(); }
  const Sampler* sampler() const noexcept override { return evaluator_.sampler(); }
  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override {
    count_.fetch_add(count, std::memory_order_relaxed);
    evaluator_.evaluate(batch, first, count, costs, collided);
  }

 private:
  const BatchEvaluator& evaluator_;
  mutable std::atomic<int> count_{0};
};

/// The frame of the solvers of this library: copies, and what begins and ends a solve. `Self` has
///
///     void compute(const BatchEvaluator&, const SolveRequest&, const Deadline&) noexcept;
///     void bind_result() noexcept;    // points the spans of the result to its own values
template <class Self>
class MethodSolver : public SolverBase {
 public:
  std::unique_ptr<Solver> clone() const override {
    auto copy = std::make_unique<Self>(static_cast<const Self&>(*this));
    copy->bind_result();
    if (result_.inputs.data() == chosen_.data()) copy->result_.inputs = copy->chosen_;
    return copy;
  }
  const SolveResult& solve(const BatchEvaluator& problem, const SolveRequest& request) noexcept override {
    const auto start = Clock::now();
    const CountingEvaluator evaluator(problem);
    result_.times = {};
    static_cast<Self&>(*this).bind_result();
    reserve_ = std::clamp(reserve_, 0.0, std::max(0.8 * request.deadline, 0.0));
    static_cast<Self&>(*this).compute(evaluator, request, Deadline(start, request.deadline - reserve_));
    if (this->takes_proposals() && !Self::plan_is_cheapest) this->choose(evaluator, request.proposals);
    result_.rollouts = evaluator.count();
    result_.times.total = seconds(start, Clock::now());
    learn_reserve(result_.times.total - request.deadline, 0.1 * request.deadline);
    return result_;
  }

 private:
  /// Fits the time that is kept for the end of a solve, after the last samples, to how late this one was (s).
  /// A solve that is late has the status of one. The reserve at most doubles, or grows by `growth` (s): the
  /// solve may have been interrupted.
  void learn_reserve(double late, double growth) noexcept {
    constexpr double earlier = 0.1;  ///< part of the time that was left over by which the reserve shrinks
    if (late > 0 && result_.status == Status::ok) result_.status = Status::deadline;
    if (result_.status != Status::deadline) return;
    reserve_ += late < 0 ? earlier * late : std::min(late, std::max(reserve_, growth));
  }

  double reserve_ = 0;  ///< s

 protected:
  using SolverBase::SolverBase;
  /// Whether `compute` itself returns the cheapest of the proposals and its own solution.
  static constexpr bool plan_is_cheapest = false;
};

}  // namespace slalom::detail
