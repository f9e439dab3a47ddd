#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "slalom/evaluation/lap.hpp"

/// A loop that remembers what was done to it, so that it can go back in time exactly.
namespace slalom::view {

enum class BodyKind { parked_car = 1, box = 2, disc = 3 };

/// The edits that can be applied to a closed loop between two ticks.
struct AddBody {
  BodyKind kind = BodyKind::disc;
  maps::Pose pose;
  double length = 0.3, width = 0.3;  ///< m; a disc's diameter is its length
};
/// Replaces all bodies that do not drive. They are numbered in this order, after the driven cars.
struct SetBodies {
  std::vector<AddBody> bodies;
};
struct MoveBody {
  int body = 0;
  maps::Pose pose;
};
struct RemoveBody {
  int body = 0;
};
struct MoveCar {
  maps::Pose pose;
};
struct ChangeDriver {
  evaluation::Driver driver;
};
using Edit = std::variant<AddBody, MoveBody, RemoveBody, SetBodies, MoveCar, ChangeDriver>;

/// The bodies of a world that do not drive, in the order of their numbers.
std::vector<AddBody> bodies_of(const sim::World& world);

/// A loop with the log of its edits. To go back, it is driven again from its start with the same seed and
/// edits: everything is deterministic, so this is exact, and no state of solvers needs to be copied. The cost
/// grows with the ticks, so the caller drives them a few at a time (see Redrive).
class Simulation {
 public:
  Simulation(const evaluation::LapSetup& setup, std::uint64_t seed);
  Simulation(Simulation&&) = default;
  Simulation& operator=(Simulation&&) = default;

  /// With `real_time` the command takes effect by what the last update took longer, as on a car.
  void tick(const evaluation::ControlStepCallback& on_step, bool real_time);
  /// Throws std::invalid_argument if the world rejects the edit, which then has no effect.
  void apply(const Edit& edit);

  /// The same loop at tick 0. With `follow` it becomes any earlier state of this one.
  Simulation from_start() const { return {first_setup_, seed_}; }
  /// Drives the next tick as `source` drove it, with the edits that `source` got before it. This simulation
  /// must come from `source.from_start()` and have fewer ticks than `source`.
  void follow(const Simulation& source);
  /// Goes back to an earlier state of this simulation, which `follow` has reached; what was done after it is
  /// forgotten.
  void go_back(Simulation&& earlier);

  int ticks() const noexcept { return loop_.steps(); }
  bool edited() const noexcept { return !log_.empty(); }
  const evaluation::LapDrive& loop() const noexcept { return loop_; }

 private:
  struct Logged {
    int tick;
    Edit edit;
  };
  void perform(const Edit& edit);

  evaluation::LapSetup first_setup_;
  std::uint64_t seed_;
  evaluation::LapDrive loop_;
  std::vector<Logged> log_;
  std::vector<float> delays_;  ///< s, by tick; as long as the last one that is not 0 asks for
  double last_update_ = 0;     ///< s of wall clock
};

}  // namespace slalom::view
