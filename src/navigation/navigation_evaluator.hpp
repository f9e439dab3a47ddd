#pragma once

#include <algorithm>
#include <array>
#include <utility>

#include "slalom/core/problem_evaluator.hpp"
#include "slalom/navigation/navigation_problem.hpp"
#include "slalom/navigation/state_cost.hpp"
#include "slalom/solvers/trajectories.hpp"

namespace slalom::navigation::detail {

/// Evaluates batches of a navigation problem, whose cost may have a term of the user's. Batches are then
/// whole, so that a term in Python is called rarely, and by one thread.
template <class Base>
class NavigationEvaluator final : public BatchEvaluator {
 public:
  using Problem = NavigationProblem<Base>;
  using State = typename Problem::template State<double>;
  static constexpr int input_count = Base::inputs;

  explicit NavigationEvaluator(Problem problem) : evaluator_(std::move(problem)) {}

  Problem& problem() noexcept { return evaluator_.problem(); }
  const Problem& problem() const noexcept { return evaluator_.problem(); }
  void set_cost(StateCost cost) noexcept { cost_ = std::move(cost); }
  /// Sets the maps of the next rollouts.
  void set_maps(const NavigationMaps& maps) noexcept {
    problem().set_maps(maps);
    origin_ = maps.origin;
  }
  void set_state(const State& state) noexcept {
    start_ = state;
    evaluator_.set_state(state);
  }
  int inputs() const noexcept override { return input_count; }
  double time_step() const noexcept override { return evaluator_.time_step(); }
  bool whole_batches() const noexcept override { return static_cast<bool>(cost_); }
  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override {
    evaluator_.evaluate(batch, first, count, costs, collided);
    if (!cost_) return;
    for (int done = 0; done < count; done += block)
      add_costs(batch, first + done, std::min(block, count - done), costs);
  }
  Cost<double> predict(const State& state, const Input<double, input_count>* u, int steps,
                       State* x) const noexcept {
    return slalom::predict(problem(), state, u, steps, x);
  }

  Trajectories roll_out(std::span<const float> sequences, int steps) const {
    return slalom::roll_out(evaluator_, start_, sequences, steps);
  }

 private:
  static constexpr int block = 1024;  ///< states in a call
  using Column = std::array<double, block>;

  void add_costs(const SequenceBatch& batch, int first, int count, float* costs) const noexcept {
    Column x, y, yaw, forward, left, turn, sums;
    std::array<Input<float, input_count>, block> before;
    const double step = time_step();
    x.fill(start_.x + origin_.x);
    y.fill(start_.y + origin_.y);
    yaw.fill(start_.yaw);
    sums.fill(0);
    for (auto& each : before)
      for (int i = 0; i < input_count; ++i) each[i] = static_cast<float>(start_.before[i]);
    const auto used = [&](Column& column) {
      return std::span(column).first(static_cast<std::size_t>(count));
    };
    for (int k = 0; k < batch.steps(); ++k) {
      for (int j = 0; j < count; ++j) {
        const auto s = static_cast<std::size_t>(j);
        Input<float, input_count> u;
        for (int i = 0; i < input_count; ++i) u[i] = batch.at(k, i, first + j);
        before[s] = problem().driven(before[s], u);
        const Motion<float> motion = problem().motion(before[s]);
        forward[s] = static_cast<double>(motion.forward);
        left[s] = static_cast<double>(motion.left);
        turn[s] = static_cast<double>(motion.turn);
      }
      cost_({k, used(x), used(y), used(yaw), used(forward), used(left), used(turn)}, used(sums));
      for (std::size_t s = 0; s < static_cast<std::size_t>(count); ++s) {
        float sine, cosine;
        sin_cos(static_cast<float>(yaw[s]), sine, cosine);
        const auto c = static_cast<double>(cosine), d = static_cast<double>(sine);
        x[s] += step * (c * forward[s] - d * left[s]);
        y[s] += step * (d * forward[s] + c * left[s]);
        yaw[s] += step * turn[s];
      }
    }
    for (int j = 0; j < count; ++j)
      costs[first + j] += static_cast<float>(step * sums[static_cast<std::size_t>(j)]);
  }

  ProblemEvaluator<Problem> evaluator_;
  StateCost cost_;
  State start_{};
  maps::Point origin_;
};

}  // namespace slalom::navigation::detail
