#pragma once

#include "slalom/core/options.hpp"
#include "slalom/evaluation/hardware.hpp"
#include "slalom/evaluation/tracking_record.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/sim/car.hpp"
#include "slalom/sim/racing_opponent.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"

namespace slalom::evaluation {

/// Most opponents of a lap that have a planner of their own.
inline constexpr int most_planning_opponents = 4;

/// The simulated cars.
enum class CarKind {
  f1tenth,        ///< the 1/10-scale car of f1tenth_gym
  passenger_car,  ///< sim::CarParameters::full_scale(), with a LiDAR that sees 150 m
  configured,     ///< that of the configuration
};
inline const char* const* enum_names(CarKind) {
  static constexpr const char* const names[] = {"f1tenth", "passenger_car", "configured", nullptr};
  return names;
}

/// Describes a driver with a planner.
struct Driver {
  vehicle::Configuration configuration;  ///< options of planner, vehicle model and methods
  std::string method = "svg_mppi";       ///< name of the method
  double speed_share = 1;                ///< share of the path's speeds that the planner is given, (0, 1]
};

/// The settings of a lap, beside its environment and driver. `visit_options` below describes the fields.
struct LapSettings {
  int obstacles = 0;                  ///< parked cars, 0 ... 1000
  std::vector<maps::Pose> parked{};   ///< places of the first of them; the others are placed at random
  std::optional<maps::Pose> start{};  ///< pose of the centre of gravity; default: the environment's
  int threads = 1;                    ///< threads of the solver, 1 ... 1024; they do not change the result
  std::optional<HardwareConditions> hardware{};  ///< sensors of a real car; Protocol::true_physics only
  /// Options of the localiser that differ from those of the conditions: names and values.
  std::vector<std::pair<std::string, std::string>> localiser{};
  std::optional<std::uint64_t> layout{};  ///< seed of the obstacle placement; default: the lap's
  /// Driver of the `planning_opponents`, with the control period of the car. Null: the driver of the car.
  std::shared_ptr<const Driver> opponent_planner{};

  // Changes of the world, for Protocol::true_physics only. visit_options declares them, so that evaluations
  // can vary them by name.
  double latency = 0;
  int opponents = 0;
  PerInput opponent_speed = 0.5;
  sim::OpponentDriver opponent_driver = sim::OpponentDriver::pursuit;
  int planning_opponents = 0;
  double opponent_gap = 0;
  int rounds = 1;
  double speed_scale = 1;
  double friction = 1.0489;
  bool saturating_tyres = false;
  CarKind car = CarKind::f1tenth;
  double steering_gain = 1;
  double range_noise = 0.01;
  double dropout = 0;
  bool localised = false;
  TrackingMode tracking = TrackingMode::automatic;
};

/// Declares the options of the world, in the section `world`.
template <class Options, class Visit>
requires is_options_of<Options, LapSettings>
void visit_options(Options& o, Visit&& visit) {
  visit(o.latency, {"latency", "s", "time from a scan until its command takes effect", 0, 1});
  visit(o.opponents, {"opponents", "", "cars that drive along the path; closed courses only", 0, 16});
  visit(o.opponent_speed,
        {"opponent_speed", "", "fraction of the path's speed: one value, or one for each opponent", 0.01, 1});
  visit(o.opponent_driver, {"opponent_driver", "", "driver of the opponents without a planner"});
  visit(o.planning_opponents,
        {"planning_opponents", "", "number of opponents with a planner, from the first ahead of the car on",
         0, most_planning_opponents});
  visit(o.opponent_gap, {"opponent_gap", "m",
                         "distance between cars at the start; 0: equal distances around the course", 0, 100});
  visit(o.rounds, {"rounds", "", "number of times around the course in a lap", 1, 100});
  visit(o.speed_scale, {"speed_scale", "", "factor of the course's speed profile", 0.1, 3});
  visit(o.friction, {"friction", "", "coefficient between tyre and road", 0.1, 3});
  visit(o.saturating_tyres, {"saturating_tyres", "", "limited tyre forces: the car can slide"});
  visit(o.car, {"car", "", "the simulated cars and their LiDAR; configured: those of vehicle and planner"});
  visit(o.steering_gain, {"steering_gain", "", "angle of the wheels / commanded angle", 0.1, 10});
  visit(o.range_noise, {"range_noise", "m", "standard deviation of each range", 0, 1});
  visit(o.dropout, {"dropout", "", "fraction of beams without a return", 0, 1});
  visit(o.localised,
        {"localised", "",
         "estimate the planner's pose and speed from LiDAR, wheels and gyro, and give it the IMU"});
  visit(o.tracking,
        {"tracking", "",
         "pose with which other cars are tracked, for planner.predict_others and to measure the tracker"});
}

/// Returns the parameters of the simulated cars. A configured one has the lengths, mass, tyres, motor and
/// steering of the configuration, without the lag of the servo; the middle of its body is its centre of
/// gravity. The friction is that of the settings, since it is a property of the floor.
sim::CarParameters car_of(const LapSettings& settings, const vehicle::Configuration& configuration);
/// Returns the sensors and actuators of a real car, if the lap has them: `hardware`, or with `localised`
/// HardwareConditions::sensors.
std::optional<HardwareConditions> hardware_of(const LapSettings& settings);

/// Sets the option that `key` names, for instance "world.friction" or "localiser.particles", from text.
/// Returns false if `key` begins with neither "world." nor "localiser.". Throws std::invalid_argument naming
/// the key, the value and the rule it breaks.
bool set_world_option(LapSettings& settings, std::string_view key, std::string_view text);

}  // namespace slalom::evaluation
