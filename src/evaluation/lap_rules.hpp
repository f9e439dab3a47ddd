#pragma once

#include "slalom/evaluation/environment.hpp"
#include "slalom/evaluation/lap_settings.hpp"
#include "slalom/maps/laser_scan.hpp"
#include "slalom/sim/placement.hpp"
#include "slalom/sim/world.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"

namespace slalom::evaluation {

/// The differences between the two protocols of a lap: published_protocol.cpp implements the published one,
/// standard_protocol.cpp that of Slalom. No other code depends on which one applies.
class LapRules {
 public:
  virtual ~LapRules() = default;

  /// The way images of maps are read.
  virtual maps::MapRule map_rule() const noexcept = 0;
  /// Whether a car that leaves the map has hit a wall.
  virtual bool outside_is_wall() const noexcept = 0;
  /// Sets start and timeout from the table of known courses, if the protocol prescribes them.
  virtual void complete(Environment& environment, const std::filesystem::path& folder,
                        const std::vector<std::filesystem::path>& course_roots) const = 0;

  /// The world before the settings of a lap are applied.
  virtual sim::WorldOptions world_options() const = 0;
  /// Applies settings and control period to the world. Does not throw, since `check` has been called.
  virtual void configure(sim::WorldOptions& options, const LapSettings& settings,
                         const vehicle::Configuration& configuration) const = 0;
  /// Throws std::invalid_argument on settings that the protocol excludes.
  virtual void check(const LapSettings& settings) const = 0;
  /// Simulated time per command, s.
  virtual double control_period(const vehicle::Configuration& configuration) const noexcept = 0;

  /// Returns the places of the parked cars of a lap, which have the size of `car`. Throws std::runtime_error
  /// if there is no room for them.
  virtual std::vector<maps::Pose> place_obstacles(const Environment& environment, int obstacles,
                                                  std::uint64_t seed, const maps::Point& start,
                                                  const sim::CarParameters& car) const = 0;

  /// The scan as the planner gets it.
  virtual maps::LaserScanView scan(const sim::Observation& seen, const sim::World& world) const noexcept = 0;
  /// The command as the car gets it.
  virtual Command command(const Command& planned) const noexcept = 0;

  /// Whether a lap of an open course ends at the end of its path.
  virtual bool finishes_open_courses() const noexcept = 0;
  /// Whether a lap of a closed course is complete; `progress` in [0, 1].
  virtual bool lap_complete(const sim::World& world, double progress) const noexcept = 0;
  /// Time of a finished lap of a closed course, s.
  virtual double lap_time(const sim::World& world) const noexcept = 0;
  /// The number of collisions so far.
  virtual int collisions(const sim::CollisionLog& log) const noexcept = 0;
};

/// The rules of a protocol; they live as long as the program.
const LapRules& rules_of(Protocol protocol) noexcept;

namespace detail {
const LapRules& standard_rules() noexcept;
const LapRules& published_rules() noexcept;
}  // namespace detail

}  // namespace slalom::evaluation
