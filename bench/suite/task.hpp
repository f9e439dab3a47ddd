#pragma once

#include <bit>

#include "slalom/problems/arm.hpp"
#include "slalom/slalom.hpp"

/// Control problems with a criterion of success, solved in closed loop by any method.
namespace slalom::suite {

/// The verdict on a state of a closed loop.
enum class Verdict { running, failed, solved };

/// The outcome of some runs.
struct Outcome {
  int solved = 0;             ///< runs
  std::vector<double> costs;  ///< of the closed loop, for each run; infinite if it was not solved
  std::vector<float> plan;    ///< inputs of the last solve, [step][input]
};

/// Closed-loop runs of a task.
struct Runs {
  SolverOptions options;    ///< method
  std::uint64_t first = 0;  ///< seed of the first run; the others follow
  int count = 0;            ///< number
  int steps = 0;            ///< most steps of a run; 0: those of the task
  /// Whether the plant differs from the model: in each run, each input acts with 80 to 120 % and a fifth of a
  /// step late, with normal noise of 5 % of its range; normal noise of 10 % of its change in a step is
  /// added to each state.
  bool disturbed = false;
};

/// An input of a task.
struct TaskInput {
  double low, high;  ///< bounds
};

/// Whether there are several ways, between which an average fails.
enum class Ways { one, several };

/// A task: a problem, the ranges of its inputs, and closed-loop runs.
struct Task {
  std::string name;
  Ways ways;
  int horizon;  ///< steps
  std::vector<TaskInput> inputs;
  std::function<Outcome(const Runs&)> run;  ///< drives the closed loop
};

/// A value of each input of a task.
inline PerInput per_input(const Task& task, double TaskInput::*value) {
  std::vector<double> values;
  for (const TaskInput& input : task.inputs) values.push_back(input.*value);
  return PerInput(values);
}

/// The default options of a method, with the horizon and the bounds of a task.
inline SolverOptions default_options(const char* method, const Task& task) {
  SolverOptions options = solver_options(method);
  *options.find<int>("horizon") = task.horizon;
  *options.find<PerInput>("input_min") = per_input(task, &TaskInput::low);
  *options.find<PerInput>("input_max") = per_input(task, &TaskInput::high);
  return options;
}

/// Adds normal noise of 10 % of the change since `before` to each value of a state.
template <class State>
void disturb(const State& before, State& after, RandomStream& random) {
  using Values = std::array<double, sizeof(State) / sizeof(double)>;
  const auto old = std::bit_cast<Values>(before);
  auto values = std::bit_cast<Values>(after);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += 0.1 * (values[i] - old[i]) * random.normal();
  after = std::bit_cast<State>(values);
}

/// Closed-loop runs of a controller of problem P from `start`. `judge(problem, x, k)` gives the verdict on
/// the state after step k; a run of `steps` steps without a verdict has failed. `change(problem, x, k)`, if
/// given, changes the problem before the solve of step k.
template <class P, class Judge, class Change = std::nullptr_t>
auto closed_loop(const P& problem, const typename P::template State<double>& start, int steps, Judge judge,
                 Change change = nullptr) {
  return [=](const Runs& runs) {
    Outcome outcome;
    Controller controller(problem, runs.options);
    const auto end_cost = [&](const auto& x) {
      return predict(controller.problem(), x, static_cast<const Input<double, P::inputs>*>(nullptr), 0,
                     static_cast<typename P::template State<double>*>(nullptr))
          .value;
    };
    for (int run = 0; run < runs.count; ++run) {
      const std::uint64_t seed = runs.first + static_cast<std::uint64_t>(run);
      controller.reset(seed);
      controller.problem() = problem;
      auto x = start;
      RandomStream random({seed, 1});
      Input<double, P::inputs> gain, last{};
      for (int i = 0; i < P::inputs; ++i) gain[i] = runs.disturbed ? 0.8 + 0.4 * random.uniform() : 1;
      double cost = 0;
      Verdict verdict = Verdict::running;
      const int most = runs.steps > 0 ? std::min(runs.steps, steps) : steps;
      for (int k = 0; k < most && verdict == Verdict::running; ++k) {
        if constexpr (!std::is_same_v<Change, std::nullptr_t>) change(controller.problem(), x, k);
        const auto plan = controller.solve(x, {.elapsed = problem.dt});
        outcome.plan.assign(plan.stats.inputs.begin(), plan.stats.inputs.end());
        Input<double, P::inputs> u = plan.inputs[0];
        for (int i = 0; runs.disturbed && i < P::inputs; ++i) {
          const double range = controller.bounds().high[i] - controller.bounds().low[i];
          const double delayed = k > 0 ? 0.8 * u[i] + 0.2 * last[i] : u[i];
          last[i] = u[i];
          u[i] = gain[i] * delayed + 0.05 * range * random.normal();
        }
        std::array<typename P::template State<double>, 2> states;
        cost += predict(controller.problem(), x, &u, 1, states.data()).value - end_cost(states[1]);
        if (runs.disturbed) disturb(states[0], states[1], random);
        x = states[1];
        verdict = judge(controller.problem(), x, k);
      }
      outcome.solved += verdict == Verdict::solved;
      outcome.costs.push_back(verdict == Verdict::solved ? cost + end_cost(x)
                                                         : std::numeric_limits<double>::infinity());
    }
    return outcome;
  };
}

/// Failed or solved at the last of `steps` steps, running before.
inline Verdict at_end(int k, int steps, bool reached) {
  if (k + 1 < steps) return Verdict::running;
  return reached ? Verdict::solved : Verdict::failed;
}

/// The distance between two points in the plane.
template <class T>
T apart(const T& x, const T& y, double to_x, double to_y) {
  return sqrt(square(x - T(to_x)) + square(y - T(to_y)) + T(1e-6));
}

/// The cost of a step: distance from the goal, effort, and collision.
template <class T, int n>
Cost<T> step_cost(double dt, const T& distance, double weight, const Input<T, n>& u, const mask_t<T>& hit) {
  T effort(0);
  for (int i = 0; i < n; ++i) effort += square(u[i]);
  return {T(dt) * (distance + T(weight) * effort) + select(hit, T(50), T(0)), hit};
}

/// Ends a run at a collision or at the goal.
inline Verdict reached(bool collides, bool at_goal) {
  return collides ? Verdict::failed : at_goal ? Verdict::solved : Verdict::running;
}

/// A mass point in the plane, driven by its accelerations.
struct PointMass {
  template <class T>
  struct State {
    T x, y, speed_x, speed_y;  // m, m/s
  };
  static constexpr int inputs = 2;  // m/s^2
  double dt = 0.1;                  // s

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 2>& u) const {
    const T speed_x = s.speed_x + T(dt) * u[0], speed_y = s.speed_y + T(dt) * u[1];
    return {s.x + T(dt) * speed_x, s.y + T(dt) * speed_y, speed_x, speed_y};
  }
};

/// The inputs of the arm: rates of its joints.
inline std::vector<TaskInput> joint_rates() {
  return std::vector<TaskInput>(problems::Arm::joints, {-1.5, 1.5});
}

/// The state in which the arm starts.
inline problems::Arm::State<double> arm_start() {
  problems::Arm::State<double> state;
  std::copy(problems::Arm::start.begin(), problems::Arm::start.end(), state.angle);
  return state;
}

/// Adds a task.
inline void add(std::vector<Task>& tasks, const char* name, Ways ways, int horizon,
                const std::vector<TaskInput>& inputs, const std::function<Outcome(const Runs&)>& run) {
  tasks.push_back({name, ways, horizon, inputs, run});
}

/// Adds the problems of the examples.
void add_example_tasks(std::vector<Task>& tasks);
/// Adds robots that move in a plane.
void add_plane_tasks(std::vector<Task>& tasks);
/// Adds vehicles and arms in narrow places.
void add_narrow_tasks(std::vector<Task>& tasks);
/// Adds loads, vehicles and schedules with models of a few lines.
void add_further_tasks(std::vector<Task>& tasks);

/// Tasks that are solved by exactness, which are not among all_tasks().
std::vector<Task> holding_tasks();

inline std::vector<Task> all_tasks() {
  std::vector<Task> tasks;
  add_example_tasks(tasks);
  add_plane_tasks(tasks);
  add_narrow_tasks(tasks);
  add_further_tasks(tasks);
  return tasks;
}

}  // namespace slalom::suite
