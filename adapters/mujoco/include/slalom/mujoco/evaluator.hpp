#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <concepts>
#include <limits>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "slalom/core/batch_evaluator.hpp"
#include "slalom/core/options.hpp"
#include "slalom/core/problem.hpp"
#include "slalom/core/thread_pool.hpp"
#include "slalom/mujoco/model.hpp"
#include "slalom/mujoco/simulation.hpp"

namespace slalom::mujoco {

/// The task of a model: its sizes, which are compared with those of the model, and its costs. Both
/// costs see the simulation after `mj_step1`: positions, velocities and what follows from them, such as
/// `xpos`, `subtree_com` and sensors of both, are those of the state; `ctrl` holds the inputs of the step.
/// Contacts are those of the state, and accelerations and contact forces those of the time step before. A
/// cost is a `double`, or a `Cost<double>` that also says whether the state collides. Costs do not throw, and
/// several threads call them at once.
///
///     struct SwingUp {
///       static constexpr int positions = 2, velocities = 2, inputs = 1;  // nq, nv, nu of the model
///       double stage_cost(const mjModel& model, const mjData& data) const;
///       double terminal_cost(const mjModel& model, const mjData& data) const;
///     };
///
/// A model with activations has `static constexpr int activations` beside them, its na.
template <class T>
concept Task = requires(const T& task, const mjModel& model, const mjData& data) {
  requires(T::positions > 0 && T::velocities > 0 && T::inputs > 0);
  task.stage_cost(model, data);
  task.terminal_cost(model, data);
};

/// The state of a MuJoCo model with as many positions (nq), velocities (nv) and activations (na): together
/// with the inputs it determines the next states.
template <int Positions, int Velocities, int Activations = 0>
struct State {
  static constexpr int size = Positions + Velocities + Activations;  ///< values beside the time

  double time = 0;           ///< s
  double values[size] = {};  ///< qpos, then qvel, then act, in the units of the model

  double* positions() noexcept { return values; }                                         ///< qpos [nq]
  const double* positions() const noexcept { return values; }                             ///< qpos [nq]
  double* velocities() noexcept { return values + Positions; }                            ///< qvel [nv]
  const double* velocities() const noexcept { return values + Positions; }                ///< qvel [nv]
  double* activations() noexcept { return values + Positions + Velocities; }              ///< act [na]
  const double* activations() const noexcept { return values + Positions + Velocities; }  ///< act [na]
};

/// Options of the rollouts of a model. `visit_options` below describes the fields.
struct RolloutOptions {
  int physics_steps = 1;
  int threads = 1;
};

template <class Options, class Visit>
requires is_options_of<Options, RolloutOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.physics_steps,
        {"physics_steps", "",
         "time steps of the model in a step of the control sequence, with the same inputs", 1, 10000});
  visit(o.threads,
        {"threads", "", "threads that simulate, each with its own mjData; the costs do not depend on it", 1,
         1024});
}

/// The number of control sequences that were simulated, and of those whose simulation became invalid.
struct RolloutCount {
  long simulated = 0;  ///< all
  long invalid = 0;    ///< those that diverged, or whose contacts or constraints did not fit into the memory
};

namespace detail {

template <class T>
constexpr int activations_of() {
  if constexpr (requires { T::activations; }) return T::activations;
  return 0;
}

/// Sizes of a model or a task.
struct Sizes {
  int positions, velocities, activations, inputs;
};

/// Throws std::invalid_argument with the model's file if it has other sizes, or what a rollout cannot do.
void check_model(const Model& model, const Sizes& task);

/// The range of an input of a model: infinite where the model does not limit it.
std::pair<double, double> input_range(const Model& model, int input);

}  // namespace detail

/// Evaluates control sequences by simulating a MuJoCo model: with a `Controller`, any method plans for it.
///
///     Controller controller{mujoco::Evaluator{mujoco::Model{"cart_pole.xml"}, SwingUp{}, {.threads = 4}},
///                           SvgMppiOptions{.horizon = 50}};
///     const auto plan = controller.solve(controller.evaluator().state_of(data), {.elapsed = 0.02});
///
/// The inputs are the model's `ctrl`, within its `ctrlrange`. A rollout ends where the simulation is no
/// longer valid (simulation.hpp): it collides, and its cost is infinite. Every rollout starts without a warm
/// start, so the same seed gives the same plan on any number of threads. A copy has simulations of its own
/// and shares the threads.
template <Task T>
class Evaluator final : public BatchEvaluator {
 public:
  using State =
      mujoco::State<T::positions, T::velocities, detail::activations_of<T>()>;  ///< state of the model
  static constexpr int input_count = T::inputs;                                 ///< inputs per step

  /// The properties of the inputs that a controller needs.
  struct Inputs {
    static constexpr int inputs = T::inputs;    ///< inputs per step
    std::array<double, T::inputs> input_min{};  ///< lower bounds
    std::array<double, T::inputs> input_max{};  ///< upper bounds
    double dt = 0;                              ///< duration of a step, s
  };

  /// Throws std::invalid_argument if task or options do not fit the model, and std::bad_alloc.
  explicit Evaluator(Model model, T task, const RolloutOptions& options = {})
      : model_(std::move(model)), task_(std::move(task)), physics_steps_(options.physics_steps) {
    validate_options(options, "rollouts");
    detail::check_model(model_, {T::positions, T::velocities, detail::activations_of<T>(), T::inputs});
    for (int i = 0; i < T::inputs; ++i) {
      const auto at = static_cast<std::size_t>(i);
      std::tie(inputs_.input_min[at], inputs_.input_max[at]) = detail::input_range(model_, i);
    }
    inputs_.dt = model_->opt.timestep * physics_steps_;
    for (int i = 0; i < options.threads; ++i) workers_.push_back({Simulation(model_), {}});
    pool_ = std::make_unique<ThreadPool>(options.threads);
  }

  const Model& model() const noexcept { return model_; }      ///< the model
  T& task() noexcept { return task_; }                        ///< the task, to change it between solves
  const T& task() const noexcept { return task_; }            ///< the task
  const Inputs& problem() const noexcept { return inputs_; }  ///< the bounds of the inputs

  /// The state that a simulation of the model is in.
  static State state_of(const mjData& data) noexcept {
    State state;
    state.time = data.time;
    mju_copy(state.positions(), data.qpos, T::positions);
    mju_copy(state.velocities(), data.qvel, T::velocities);
    mju_copy(state.activations(), data.act, detail::activations_of<T>());
    return state;
  }

  /// The rollouts since construction.
  RolloutCount rollouts() const noexcept {
    RolloutCount all;
    for (const Worker& worker : workers_) {
      all.simulated += worker.rollouts.simulated;
      all.invalid += worker.rollouts.invalid;
    }
    return all;
  }

  /// Sets the start of the next sequences.
  void set_state(const State& state) noexcept { state_ = state; }

  int inputs() const noexcept override { return T::inputs; }
  double time_step() const noexcept override { return inputs_.dt; }
  bool whole_batches() const noexcept override { return true; }  // the threads are those of this evaluator

  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override {
    std::atomic<int> next = first;
    pool_->run(static_cast<int>(workers_.size()), [&](int task) {
      Worker& worker = workers_[static_cast<std::size_t>(task)];
      for (int k; (k = next.fetch_add(1, std::memory_order_relaxed)) < first + count;) {
        const auto input = [&](int step, int i) { return static_cast<double>(batch.at(step, i, k)); };
        const Cost<double> cost = roll_out(worker, state_, input, batch.steps(), nullptr);
        costs[k] = static_cast<float>(cost.value);
        collided[k] = cost.collided;
      }
    });
  }

  /// The states of a control sequence u[step], x[0] = `state` and the `steps` that follow, and its cost. From
  /// the step on at which the simulation is no longer valid, the states are the last valid one.
  Cost<double> predict(const State& state, const Input<double, T::inputs>* u, int steps,
                       State* x) const noexcept {
    const auto input = [&](int step, int i) { return u[step][i]; };
    return roll_out(workers_.front(), state, input, steps, x);
  }

 private:
  /// The memory that one thread overwrites in every rollout.
  struct Worker {
    Simulation simulation;
    RolloutCount rollouts;
  };

  /// Simulates a control sequence; x may be null.
  template <class InputAt>
  Cost<double> roll_out(Worker& worker, const State& state, const InputAt& input, int steps,
                        State* x) const noexcept {
    Simulation& simulation = worker.simulation;
    Cost<double> total{0, false};
    simulation.restart(state.time, state.values);
    if (x) x[0] = state;
    ++worker.rollouts.simulated;
    int step = 0;
    for (; step < steps && advance(simulation, input, step, total); ++step)
      if (x) x[step + 1] = state_of(simulation.data());
    if (step == steps && simulation.observe()) {
      add(total, task_.terminal_cost(model_.get(), simulation.data()));
      return total;
    }
    ++worker.rollouts.invalid;
    if (x) std::fill(x + step + 1, x + steps + 1, x[step]);
    return {std::numeric_limits<double>::infinity(), true};
  }

  /// Adds the cost of a step and simulates it. Whether the simulation is valid.
  template <class InputAt>
  bool advance(Simulation& simulation, const InputAt& input, int step, Cost<double>& total) const noexcept {
    for (int i = 0; i < T::inputs; ++i) simulation.inputs()[i] = input(step, i);
    for (int physics = 0; physics < physics_steps_; ++physics) {
      if (!simulation.observe()) return false;
      if (physics == 0) add(total, task_.stage_cost(model_.get(), simulation.data()));
      if (!simulation.advance()) return false;
    }
    return true;
  }

  static void add(Cost<double>& total, double cost) noexcept { total.value += cost; }
  static void add(Cost<double>& total, const Cost<double>& cost) noexcept {
    total.value += cost.value;
    total.collided = total.collided || cost.collided;
  }

  Model model_;
  T task_;
  int physics_steps_;
  Inputs inputs_;
  State state_;
  mutable std::vector<Worker> workers_;  ///< one for each thread
  std::shared_ptr<ThreadPool> pool_;     ///< shared by copies
};

}  // namespace slalom::mujoco
