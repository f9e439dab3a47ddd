#pragma once

#include <optional>

#include "slalom/evaluation/hardware.hpp"
#include "slalom/sim/world.hpp"
#include "slalom/vehicle/localisation/localiser.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::evaluation {

/// A lap's car between the simulated one and the planner: what it measures, what its servo does.
class HardwareModel {
 public:
  /// `start` of the rear axle.
  HardwareModel(const HardwareConditions& conditions, const maps::OccupancyGrid& map,
                const sim::CarParameters& car, const sim::CarState& state, std::uint64_t seed);

  /// The world's options under these conditions; the scan's rate stays.
  static void apply(const HardwareConditions& conditions, sim::WorldOptions& options);

  /// The pose and speed that the planner is told; none while the car does not know where it is.
  std::optional<vehicle::Odometry> sense(const sim::Observation& seen, const sim::CarState& state);
  /// What the servo makes of a command within a step of `time_step` (s).
  Command servo(const Command& command, double time_step) noexcept;
  /// To be called after each step of `time_step` (s).
  void moved(const sim::CarState& state, double time_step) noexcept { wheels_.update(state, time_step); }

  const LocalisationRecord& record() const noexcept { return record_; }

 private:
  HardwareConditions conditions_;
  sim::CarParameters car_;
  sim::WheelOdometry wheels_;
  vehicle::Localiser localiser_;
  LocalisationRecord record_;
  double steer_ = 0;     ///< rad, of the servo
  double known_at_ = 0;  ///< s, when the pose was last good
};

}  // namespace slalom::evaluation
