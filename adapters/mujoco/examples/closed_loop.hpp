#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>

#include <slalom/mujoco/evaluator.hpp>
#include <slalom/slalom.hpp>

/// The model that the plans move, as MuJoCo simulates it by itself.
class World {
 public:
  explicit World(const slalom::mujoco::Model& model) : model_(model), data_(mj_makeData(&model.get())) {}

  mjData& data() { return *data_; }

  /// Applies inputs for some time steps of the model.
  template <int N>
  void step(const slalom::Input<double, N>& inputs, int physics_steps) {
    for (int i = 0; i < N; ++i) data_->ctrl[i] = inputs[i];
    for (int i = 0; i < physics_steps; ++i) mj_step(&model_.get(), data_.get());
  }

 private:
  struct Delete {
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  slalom::mujoco::Model model_;
  std::unique_ptr<mjData, Delete> data_;
};

/// The results of the runs of all seeds.
struct Summary {
  int runs = 0, succeeded = 0;
  long rollouts = 0, invalid = 0;
  double simulated = 0;       ///< s, in closed loop
  double rolled_out = 0;      ///< s, in the rollouts of all solves
  double processor_time = 0;  ///< s, of solves and steps

  /// Prints the figures. The exit code is 0 if all runs succeeded.
  int report(const char* what) const {
    std::printf("%s: %d of %d runs; %ld rollouts, %ld of them invalid\n", what, succeeded, runs, rollouts,
                invalid);
    std::printf("simulated time over processor time: %.2f in closed loop, %.0f in rollouts\n",
                simulated / processor_time, rolled_out / processor_time);
    return succeeded == runs ? 0 : 1;
  }
};

/// Drives a task for some time (s) with each seed. `begin(world, random)` sets the start; a run succeeds if
/// `is_good(data)` holds after every step.
template <class Task, class Options, class Begin, class IsGood>
Summary drive(const slalom::mujoco::Model& model, const Task& task, Options options, int physics_steps,
              double duration, std::uint64_t seeds, Begin&& begin, IsGood&& is_good) {
  Summary summary;
  for (options.seed = 0; options.seed < seeds; ++options.seed) {
    slalom::Controller controller{slalom::mujoco::Evaluator{model, task, {.physics_steps = physics_steps}},
                                  options};
    World world(model);
    slalom::RandomStream random({.seed = options.seed});
    begin(world, random);
    const auto& evaluator = controller.evaluator();
    const double dt = evaluator.time_step();
    bool succeeds = true;
    const std::clock_t start = std::clock();
    for (double t = 0; t < duration; t += dt) {
      const auto plan = controller.solve(evaluator.state_of(world.data()), {.elapsed = dt});
      world.step(plan.inputs[0], physics_steps);
      if (!is_good(world.data())) succeeds = false;
    }
    summary.processor_time += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    summary.simulated += duration;
    summary.rollouts += evaluator.rollouts().simulated;
    summary.invalid += evaluator.rollouts().invalid;
    summary.rolled_out +=
        static_cast<double>(evaluator.rollouts().simulated) * controller.solver().horizon() * dt;
    ++summary.runs;
    summary.succeeded += succeeds;
  }
  return summary;
}

/// The number of seeds that an argument asks for.
inline std::uint64_t seeds_of(int argc, char** argv, const char* otherwise) {
  return std::strtoull(argc > 2 ? argv[2] : otherwise, nullptr, 10);
}
