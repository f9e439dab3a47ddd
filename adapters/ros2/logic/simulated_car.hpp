#pragma once

#include "slalom/evaluation/environment.hpp"
#include "slalom/maps/command.hpp"
#include "slalom/sim/wheel_odometry.hpp"
#include "slalom/sim/world.hpp"

namespace slalom::nodes {

/// A simulated car with wheel odometry and a Hokuyo UTM-30LX, on a course with parked cars.
class SimulatedCar {
 public:
  static constexpr double period = 0.025;  ///< s, duration of a step

  /// Prepares a course and places `obstacles` parked cars, and another car at `other`, if it is given; `seed`
  /// is for the noise and the parked cars. Throws std::exception with a message for the user.
  SimulatedCar(const vehicle::Course& course, std::uint64_t seed, int obstacles,
               const std::optional<maps::Pose>& other = {});

  /// Puts the car back to the start.
  void reset();
  /// Drives for a period; `other` commands the other car.
  void step(const Command& command, const Command& other = {});

  maps::LaserScanView scan() const { return world_.observe(0).scan; }  ///< valid until the next step
  const sim::WheelOdometry& odometry() const { return odometry_; }     ///< measured motion of the rear axle
  maps::Pose pose() const;                                             ///< pose of the rear axle, map frame
  int laps() const { return world_.laps(0) ? world_.laps(0)->laps() : 0; }
  int collisions() const { return collisions_; }                                 ///< number of collisions
  const std::vector<maps::Pose>& parked() const { return parked_; }              ///< their centres, map frame
  const sim::CarParameters& parameters() const { return world_.options().car; }  ///< sizes of all cars
  maps::Pose laser() const;                           ///< relative to the rear axle
  const sim::World& world() const { return world_; }  ///< the world with all cars

 private:
  std::shared_ptr<const evaluation::Environment> environment_;
  std::uint64_t seed_;
  sim::World world_;
  sim::WheelOdometry odometry_;
  std::vector<maps::Pose> parked_, starts_;
  int collisions_ = 0;
  bool colliding_ = false;
};

}  // namespace slalom::nodes
