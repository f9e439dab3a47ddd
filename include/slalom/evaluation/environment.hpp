#pragma once

#include "slalom/maps/reference_path.hpp"
#include "slalom/sim/track.hpp"
#include "slalom/sim/world.hpp"
#include "slalom/vehicle/course/course.hpp"

/// Laps that are counted and compared: the environment, one lap in lockstep, and evaluations of many laps.
namespace slalom::evaluation {

/// The rules of a lap: simulated world, clock, placement of obstacles, and how collisions are counted.
enum class Protocol {
  true_physics,  ///< named "true": a command every control period; collisions = different bodies hit
  published,  ///< as in the program of Honda et al. (ICRA 2024): f1tenth_gym, one step of 0.01 s per command,
              ///< its way of counting
};
/// Returns the name of a protocol in configurations and results: "true" or "published".
const char* name(Protocol protocol);
/// Returns the protocol of this name. Throws std::invalid_argument unless `text` is "true" or "published".
Protocol protocol_named(std::string_view text);

/// A course prepared for driving under one protocol. It is expensive to make, does not change, and can be
/// shared by any number of laps and threads.
struct Environment {
  Protocol protocol = Protocol::true_physics;  ///< rules of world, clock and counting
  vehicle::Course course;                      ///< the course
  std::shared_ptr<const sim::Track>
      track;                               ///< walls with their distance field, and the path that counts laps
  std::vector<maps::ReferencePoint> path;  ///< the waypoints of the course
  /// Distance to the wall on the wider side, for each point of the course's obstacle path, m; at most 10.
  std::vector<double> obstacle_room;
  maps::Pose start;        ///< pose of the centre of gravity, relative to the course's origin
  double start_moved = 0;  ///< m along the waypoints; above 0 if the first one is in a wall
  double timeout = 0;      ///< s, for one time around the course; 0: three laps of the speed profile
  std::optional<sim::LidarOptions> lidar;  ///< replaces the LiDAR of the protocol

  /// Returns the options of the protocol's world, with `lidar` if it is given, without the settings of a lap
  /// (noise, friction, control period).
  sim::WorldOptions world_options() const;
};

/// Prepares a course. Throws std::invalid_argument if its path or map cannot be driven on.
std::shared_ptr<Environment> make_environment(vehicle::Course course, Protocol protocol);

/// Loads the course in `folder`, moves it to its local origin and prepares it. Under Protocol::published
/// start and timeout come from the table of known courses in `course_roots`, if the course is in it. Throws
/// IoError, std::invalid_argument.
std::shared_ptr<const Environment> load_environment(const std::filesystem::path& folder, Protocol protocol,
                                                    const std::vector<std::filesystem::path>& course_roots);

}  // namespace slalom::evaluation
