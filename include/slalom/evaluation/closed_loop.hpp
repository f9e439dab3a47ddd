#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "slalom/evaluation/lap_runner.hpp"

namespace slalom::evaluation {

/// A drive that somebody else steps, looks into and meddles with. As long as nobody meddles, its first lap is
/// that of LapRunner::run with the same seed, bit for bit; after the finish the car drives on. The same
/// meddling at the same ticks gives the same drive.
class ClosedLoop {
 public:
  /// Throws as LapRunner::run does.
  ClosedLoop(std::shared_ptr<const LapRunner> runner, std::uint64_t seed);
  ~ClosedLoop();
  ClosedLoop(ClosedLoop&&) noexcept;
  ClosedLoop& operator=(ClosedLoop&&) noexcept;

  /// One control period: a planner update, then the world until the next one. `further_latency` (s) is added
  /// to the settings' for this command alone.
  void tick(const ControlStepCallback& on_step = {}, double further_latency = 0);

  /// From the next tick on another configuration or method drives, with a planner that begins anew. The
  /// environment must be the same and the control period too; throws std::invalid_argument otherwise.
  void change_controller(std::shared_ptr<const LapRunner> runner);

  int ticks() const noexcept;
  sim::World& world() noexcept;
  const sim::World& world() const noexcept;
  const LapRunner& runner() const noexcept { return *runner_; }
  /// Contacts so far, by the evaluation's way of counting.
  int collisions() const noexcept;
  /// The first touch of each body so far.
  std::span<const Collision> first_collisions() const noexcept;

 private:
  std::shared_ptr<const LapRunner> runner_;
  std::uint64_t seed_;
  std::unique_ptr<LapRunner::Drive> drive_;
};

}  // namespace slalom::evaluation
