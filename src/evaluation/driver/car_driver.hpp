#pragma once

#include "evaluation/hardware_model.hpp"
#include "evaluation/lap_rules.hpp"
#include "evaluation/tracking/tracking_meter.hpp"
#include "slalom/evaluation/drive.hpp"
#include "slalom/evaluation/lap.hpp"
#include "slalom/sim/pure_pursuit.hpp"
#include "slalom/sim/racing_opponent.hpp"
#include "slalom/tracking/predictor.hpp"

namespace slalom::evaluation {

/// An update of a planner, with its inputs. Valid until the driver's next update.
struct PlannerUpdate {
  sim::Observation seen;                           ///< the true state of the car
  maps::LaserScanView scan;                        ///< input of the planner
  vehicle::Odometry odometry;                      ///< input of the planner; if not `localised`, the true one
  bool localised = true;                           ///< whether the planner was given a pose
  const vehicle::PlannerOutput* output = nullptr;  ///< null for drivers without a planner
  std::span<const maps::PredictedObstacle> others{};  ///< input of the planner
};

/// A driver with a planner. It also has sensors, a localiser, a tracker and a predictor of other cars, and
/// the commands that have not taken effect yet.
class PlanningDriver {
 public:
  /// Drives car `car` of a world that has been reset. All random numbers follow from `seed` and `label`;
  /// drivers of one world have different labels.
  PlanningDriver(const LapSetup& setup, const sim::World& world, std::size_t car, std::uint64_t seed,
                 const std::string& label = {});

  /// Senses, tracks and plans, and queues the command.
  PlannerUpdate decide(const sim::World& world);
  /// The command for the next step of the world.
  Command command(const sim::World& world);
  /// Moves the sensors after a step of the world.
  void moved(const sim::World& world) noexcept;

  /// Replaces the planner. Sensors and tracker stay.
  void change(vehicle::Planner planner) noexcept { planner_ = std::move(planner); }
  /// Lets the next commands take effect `latency` (s) later than the settings say.
  void set_extra_latency(double latency) noexcept { extra_latency_ = latency; }

  const vehicle::Planner& planner() const noexcept { return planner_; }
  /// The sensors of a real car; null if the planner gets exact measurements.
  const HardwareModel* hardware() const noexcept { return hardware_ ? &*hardware_ : nullptr; }
  /// The tracker with its figures; null with TrackingMode::off.
  const TrackingMeter* tracking() const noexcept { return tracking_ ? &*tracking_ : nullptr; }

 private:
  const LapRules* rules_;
  double latency_, extra_latency_ = 0;  ///< s
  double steering_gain_;
  std::size_t car_;
  vehicle::Planner planner_;
  std::optional<HardwareModel> hardware_;
  std::optional<TrackingMeter> tracking_;
  std::optional<tracking::Predictor> predictor_;  ///< predictor of the tracked cars
  Command applied_;                               ///< the command that the car executes now
  /// Commands that were sent but not yet applied, each with the step of the world in which it takes effect.
  std::vector<std::pair<std::int64_t, Command>> pending_;
};

/// The driver of a car: one that follows the path, one that reacts to the true states of all cars, or one
/// with sensors and a planner.
class CarDriver {
 public:
  template <class Law>
  CarDriver(std::size_t car, Law law) : car_(car), law_(std::move(law)) {}

  /// Decides once per control period, unless the car has left the track.
  PlannerUpdate decide(const sim::World& world);
  /// The command for the next step of the world.
  Command command(const sim::World& world);
  /// Moves the sensors after a step of the world.
  void moved(const sim::World& world) noexcept;
  /// Returns the driver with a planner; this driver must be one.
  PlanningDriver& planning() noexcept { return std::get<PlanningDriver>(law_); }
  const PlanningDriver& planning() const noexcept { return std::get<PlanningDriver>(law_); }

 private:
  std::size_t car_;
  std::variant<sim::PurePursuit, sim::RacingOpponent, PlanningDriver> law_;
  Command decided_;  ///< command of a RacingOpponent, until it decides again
};

/// The drive of a lap or race.
using CarDrive = Drive<sim::World, CarDriver>;
/// Makes the drive of a lap: places the obstacles, whose poses are returned in `obstacles`, and puts the cars
/// at their starts.
CarDrive start_lap(const LapSetup& setup, std::uint64_t seed, std::vector<maps::Pose>& obstacles);

}  // namespace slalom::evaluation
