#pragma once

#include "slalom/evaluation/hardware.hpp"
#include "slalom/sim/world.hpp"
#include "slalom/vehicle/localisation/localiser.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::evaluation {

/// Sensors and servo of a car between simulation and planner: measured scan, localised pose, servo angle.
class HardwareModel {
 public:
  /// Starts with the car in `state`, and the localiser at its true pose. `seed` is that of all random errors.
  HardwareModel(const HardwareConditions& conditions, const maps::OccupancyGrid& map,
                const sim::CarParameters& car, const sim::CarState& state, std::uint64_t seed);

  /// Applies the conditions to the options of a world. The scan rate is kept.
  static void apply(const HardwareConditions& conditions, sim::WorldOptions& options);

  /// The pose and speed that the planner gets; none while the car is not localised.
  std::optional<vehicle::Odometry> sense(const sim::Observation& seen, const sim::CarState& state);
  /// The command after the servo, in a step of `time_step` (s).
  Command servo(const Command& command, double time_step) noexcept;
  /// Updates wheel odometry and inertial measurement unit; to be called after each step of `time_step` (s).
  void moved(const sim::CarState& state, double time_step) noexcept {
    wheels_.update(state, time_step);
    imu_.update(state, time_step);
  }
  /// The reading of the inertial measurement unit since the last call, if the car has one.
  std::optional<ImuReading> read_imu() noexcept;

  /// Errors of the localisation so far.
  const LocalisationRecord& record() const noexcept { return record_; }

 private:
  HardwareConditions conditions_;
  sim::CarParameters car_;
  sim::WheelOdometry wheels_;
  sim::Imu imu_;
  vehicle::Localiser localiser_;
  LocalisationRecord record_;
  double steer_ = 0;     ///< rad, of the servo
  double known_at_ = 0;  ///< s, when the pose was last localised
};

}  // namespace slalom::evaluation
