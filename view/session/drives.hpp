#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "slalom/evaluation/lap.hpp"

namespace slalom::view {

enum class BodyKind { parked_car, box, disc };

/// Adds a body that does not drive.
struct AddBody {
  BodyKind kind = BodyKind::disc;
  maps::Pose pose;
  double length = 0.3, width = 0.3;  ///< m; the length of a disc is its diameter
};
/// Replaces all bodies that do not drive; they are numbered in this order, after the driven cars.
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
/// Puts the car elsewhere, but not the ghost.
struct MoveCar {
  maps::Pose pose;
};
/// Lets another driver drive the car from the next tick on.
struct ChangeDriver {
  evaluation::Driver driver;
};
/// Starts a ghost as a copy of the car, with another driver if one is given.
struct StartGhost {
  std::optional<evaluation::Driver> driver{};
  std::string label;  ///< its name on the page
};
struct EndGhost {};
/// An action of a user between two ticks.
using Action =
    std::variant<AddBody, SetBodies, MoveBody, RemoveBody, MoveCar, ChangeDriver, StartGhost, EndGhost>;

/// The bodies of a world that do not drive, in the order of their numbers.
std::vector<AddBody> bodies_of(const sim::World& world);

/// Delays by which commands take effect later than the settings say, s.
struct Delays {
  double car = 0, ghost = 0;
};

/// The car, and the ghost if there is one, each in a world of its own. A copy goes on with the same bits.
struct Drives {
  evaluation::LapDrive car;
  std::optional<evaluation::LapDrive> ghost{};
  std::string ghost_label{};
  bool edited = false;  ///< whether the drive differs from that of the command line

  int ticks() const noexcept { return car.steps(); }
  /// Drives one control period.
  void tick(const Delays& delays, const evaluation::ControlStepCallback& on_car = {},
            const evaluation::ControlStepCallback& on_ghost = {});
  /// Throws std::invalid_argument if a world rejects the action, or a driver is not valid.
  void apply(const Action& action);
};

}  // namespace slalom::view
