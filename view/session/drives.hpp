#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "slalom/evaluation/lap.hpp"
#include "view/session/timeline.hpp"

namespace slalom::view {

/// The car, and the ghost if there is one, each in a world of its own. A copy continues bit for bit like the
/// original.
struct Drives {
  evaluation::LapDrive car;
  std::optional<evaluation::LapDrive> ghost{};
  std::string ghost_label{};
  bool edited = false;  ///< whether the drive differs from that of the command line

  int ticks() const noexcept { return car.steps(); }
  const sim::World& world() const noexcept { return car.world(); }
  /// Drives one control period.
  void tick(const Delays& delays, const evaluation::ControlStepCallback& on_car = {},
            const evaluation::ControlStepCallback& on_ghost = {});
};

/// An action of a user between two ticks. It throws std::invalid_argument, perhaps after it has changed
/// something, if a world rejects it or a driver is not valid.
using Action = std::function<void(Drives&)>;

/// A box or disc that does not drive.
struct Body {
  maps::Pose pose;
  double length = 0.3, width = 0.3;  ///< m; the length of a disc is its diameter
  bool is_disc = false;
};
/// Returns the bodies of a world that do not drive, in the order of their numbers.
std::vector<Body> bodies_of(const sim::World& world);

// These change the worlds of car and ghost.
Action add_body(const Body& body);
Action add_parked_car(const maps::Pose& pose);
Action move_body(int body, const maps::Pose& pose);
Action remove_body(int body);
/// Replaces all bodies that do not drive; they are numbered in this order, after the driven cars.
Action set_bodies(std::vector<Body> bodies);

/// Puts the car elsewhere, but not the ghost.
Action move_car(const maps::Pose& pose);
/// Lets another driver drive the car from the next tick on.
Action change_driver(evaluation::Driver driver);
/// Starts a ghost as a copy of the car, with another driver if one is given. `label`: its name on the page.
Action start_ghost(std::string label, std::optional<evaluation::Driver> driver = {});
/// Takes the ghost away.
void end_ghost(Drives& drives);

}  // namespace slalom::view
