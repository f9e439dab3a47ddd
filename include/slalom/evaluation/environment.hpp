#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "slalom/maps/reference_path.hpp"
#include "slalom/sim/track.hpp"
#include "slalom/sim/world.hpp"
#include "slalom/vehicle/course/course.hpp"

/// Laps that can be counted and compared: what is driven, how a lap is judged, one lap in lockstep.
namespace slalom::evaluation {

/// The rules of the world, of its clock and of counting.
enum class Protocol {
  true_physics,  ///< named "true": right physics, a command every control period, contacts = bodies touched
  published,     ///< as the published evaluation: f1tenth_gym, one step of 0.01 s per command, its counting
};
const char* name(Protocol protocol);
/// Throws std::invalid_argument unless `text` is "true" or "published".
Protocol protocol_named(std::string_view text);

/// A course made ready to drive on. Heavy to make, immutable, shared by any number of laps and threads.
struct Environment {
  Protocol protocol = Protocol::true_physics;
  vehicle::Course course;
  std::shared_ptr<const sim::Track> track;
  std::vector<maps::ReferencePoint> path;  ///< the course's waypoints
  std::vector<double>
      obstacle_room;   ///< m from each point of the obstacle path to the wall on its wider side
  maps::Pose start;    ///< of the car's centre of gravity, map frame
  double timeout = 0;  ///< s; 0: three times the profile's lap time
  std::optional<sim::LidarOptions> lidar;  ///< where it is not the evaluation's own

  /// The world of this evaluation.
  sim::WorldOptions world_options() const;
};

/// Makes a course ready. Throws std::invalid_argument on a path or map that cannot be driven on.
std::shared_ptr<Environment> make_environment(vehicle::Course course, Protocol protocol);

/// Loads the course in `folder`. `course_roots` are where the table of known courses lies: the published
/// evaluation takes start and timeout from it. Throws IoError, std::invalid_argument.
std::shared_ptr<const Environment> load_environment(const std::filesystem::path& folder, Protocol protocol,
                                                    const std::vector<std::filesystem::path>& course_roots);

}  // namespace slalom::evaluation
