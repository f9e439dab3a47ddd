#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "slalom/slalom.hpp"

/// Control problems with a criterion of success, solved in closed loop by any method.
namespace slalom::suite {

/// What a state of a closed loop means.
enum class Verdict { running, failed, solved };

/// The outcome of some runs.
struct Outcome {
  int solved = 0;                              ///< runs
  std::vector<double> effective_sample_sizes;  ///< of every solve
  std::vector<float> plan;                     ///< inputs of the last solve, [step][input]
};

/// Closed-loop runs of a task.
struct Runs {
  SolverOptions options;    ///< method
  std::uint64_t first = 0;  ///< seed of the first run; the others follow
  int count = 0;            ///< number
  int ilqr_iterations = 0;  ///< of a proposal by iterative LQR in every solve; 0: none
  int steps = 0;            ///< most steps of a run; 0: those of the task
};

/// A task: a problem, what is known of its inputs, and closed-loop runs.
struct Task {
  std::string name;
  bool several_ways = false;      ///< whether there are ways between which an average fails
  int horizon = 0;                ///< steps
  std::vector<double> deviation;  ///< standard deviation that samples should have, one for each input
  std::vector<double> low, high;  ///< bounds of the inputs
  std::function<Outcome(const Runs&)> run;  ///< drives the closed loop
};

/// Closed-loop runs of a controller of problem P from `start`. `judge(problem, x, k)` gives the verdict on
/// the state after step k; a run of `steps` steps without a verdict has failed. `change(problem, x, k)`, if
/// given, changes the problem before the solve of step k.
template <class P, class Judge, class Change = std::nullptr_t>
auto closed_loop(const P& problem, const typename P::template State<double>& start, int steps, Judge judge,
                 Change change = nullptr) {
  return [=](const Runs& runs) {
    Outcome outcome;
    Controller<GradientEvaluator<P>> controller(GradientEvaluator<P>(problem), runs.options);
    std::optional<Proposals<GradientEvaluator<P>>> proposals;
    if (runs.ilqr_iterations > 0) proposals.emplace(controller, 1);
    Ilqr ilqr(controller, {std::max(runs.ilqr_iterations, 1)});
    for (int run = 0; run < runs.count; ++run) {
      const std::uint64_t seed = runs.first + static_cast<std::uint64_t>(run);
      controller.reset(seed);
      ilqr.start_from({});
      controller.problem() = problem;
      auto x = start;
      Verdict verdict = Verdict::running;
      const int most = runs.steps > 0 ? std::min(runs.steps, steps) : steps;
      for (int k = 0; k < most && verdict == Verdict::running; ++k) {
        if constexpr (!std::is_same_v<Change, std::nullptr_t>) change(controller.problem(), x, k);
        SolveRequest request{.elapsed = problem.dt};
        if (proposals) {
          proposals->clear();
          proposals->add(ilqr.improve(controller.problem(), x, problem.dt));
          request.proposals = *proposals;
        }
        const auto plan = controller.solve(x, request);
        ilqr.start_from(plan.inputs);
        outcome.plan.assign(plan.stats.inputs.begin(), plan.stats.inputs.end());
        outcome.effective_sample_sizes.push_back(plan.stats.effective_sample_size);
        x = slalom::detail::step<P, double>(controller.problem(), x, NoLookUp{}, plan.inputs[0], 0);
        verdict = judge(controller.problem(), x, k);
      }
      outcome.solved += verdict == Verdict::solved;
    }
    return outcome;
  };
}

/// Adds the problems of the examples.
void add_example_tasks(std::vector<Task>& tasks);
/// Adds robots that move in a plane.
void add_plane_tasks(std::vector<Task>& tasks);
/// Adds vehicles and arms in narrow places.
void add_narrow_tasks(std::vector<Task>& tasks);

}  // namespace slalom::suite
