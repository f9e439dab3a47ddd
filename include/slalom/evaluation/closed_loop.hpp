#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "slalom/evaluation/lap_runner.hpp"

namespace slalom::evaluation {

/// World and planner in a closed loop that the caller steps and may change between steps: bodies in the
/// world, latency, the controller. Without such changes its first lap equals LapRunner::run with the same
/// seed bit for bit; after the finish the car continues. The same changes at the same steps give the same
/// result.
class ClosedLoop {
 public:
  /// `runner` must not be null. Throws as LapRunner::run does.
  ClosedLoop(std::shared_ptr<const LapRunner> runner, std::uint64_t seed);
  ~ClosedLoop();
  /// Moves the loop; the source can only be destroyed or assigned to.
  ClosedLoop(ClosedLoop&&) noexcept;
  /// Moves the loop; the source can only be destroyed or assigned to.
  ClosedLoop& operator=(ClosedLoop&&) noexcept;

  /// One control period: a planner update, then the world until the next one. `extra_latency` (s) is added to
  /// the latency of the settings for this command only.
  void step(const ControlStepCallback& on_step = {}, double extra_latency = 0);

  /// From the next step on the configuration and method of `runner` drive, with a new planner. Throws
  /// std::invalid_argument if the environment or the control period differs.
  void change_controller(std::shared_ptr<const LapRunner> runner);

  /// Control steps so far.
  int steps() const noexcept;
  /// The simulated world, which may be changed between steps.
  sim::World& world() noexcept;
  /// The simulated world.
  const sim::World& world() const noexcept;
  /// Environment, configuration and method that drive now.
  const LapRunner& runner() const noexcept { return *runner_; }
  /// The number of collisions so far, as the protocol counts them.
  int collisions() const noexcept;
  /// The first collision with each body so far, in order of time.
  std::span<const Collision> first_collisions() const noexcept;

 private:
  std::shared_ptr<const LapRunner> runner_;
  std::uint64_t seed_;
  std::unique_ptr<LapRunner::LapInProgress> lap_;
};

}  // namespace slalom::evaluation
