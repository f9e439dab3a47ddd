#pragma once

#include <filesystem>
#include <string>

#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/vehicle/course/speed_profile.hpp"

namespace slalom::vehicle {

/// The style of a generated track: how many corners, how deep and how tight.
enum class TrackCharacter { balanced, fast, twisty, narrow };

/// The name of a character.
const char* name(TrackCharacter character) noexcept;
/// The character of this name. Throws std::invalid_argument that lists the names.
TrackCharacter track_character(const std::string& name);

/// Options of a generated track. Ranges are checked by validate().
struct TrackGeneratorOptions {
  std::uint64_t seed = 0;  ///< seed of the random numbers
  double length = 60.0;    ///< length of the centre line, m, 20..1000, and at least 16 (width / 2 + wall)
  double width = 2.2;      ///< from wall to wall, m, 1.2..10
  TrackCharacter character = TrackCharacter::balanced;  ///< style of its corners
  double wall = 0.2;          ///< thickness of the walls, m, 0.1..1, at least 2 cells
  double resolution = 0.05;   ///< size of a cell of the map, m, 0.02..0.1
  double wall_margin = 0.45;  ///< the raceline keeps this far from the walls, m, 0.3.. width / 2 - 0.1
  SpeedLimits limits{};       ///< for the speed profile
};

/// Throws std::invalid_argument that names the option, its value and the rule.
void validate(const TrackGeneratorOptions& options);

/// The top speed (m/s) that suits a character: the default of `slalom track`.
double usual_top_speed(TrackCharacter character) noexcept;
/// The width (m) that suits a character: the default of `slalom track`.
double usual_width(TrackCharacter character) noexcept;

/// A point of the raceline.
struct RacelinePoint {
  double arc_length = 0;    ///< m from the start
  double x = 0, y = 0;      ///< m, map frame
  double yaw = 0;           ///< rad
  double curvature = 0;     ///< 1/m, > 0 to the left
  double speed = 0;         ///< m/s
  double acceleration = 0;  ///< m/s^2, along the path
};

/// A closed track. It starts at the first point of the raceline, which is the origin of the map frame.
struct GeneratedTrack {
  TrackGeneratorOptions options;           ///< from which it was generated
  std::vector<maps::Point> centre_line{};  ///< equal steps of about 0.1 m
  std::vector<RacelinePoint> raceline{};   ///< equal steps of about 0.11 m
  std::vector<maps::Point>
      obstacle_path{};        ///< path on which a parked car leaves room to pass it on one side
  maps::OccupancyGrid map{};  ///< free between the walls, occupied inside them, unknown beyond
  double lap_time = 0;        ///< s, at the raceline's speeds
};

/// Makes a track; the same options give the same track.
///
/// The centre line is a closed polygon with rounded corners, smoothed along its length. Its radius is nowhere
/// below max(width / 2 + wall, width / 2 - wall_margin + 0.9 m), parts that are not neighbours are at least
/// width + 2 wall apart, and it has the curvature that its character demands. Walls never meet. Throws
/// std::invalid_argument for bad options, or where no track of the length and width is found.
GeneratedTrack generate_track(const TrackGeneratorOptions& options);

/// m, the length of the raceline.
double path_length(const GeneratedTrack& track);

/// The texts that save_track writes in addition to the geometry.
struct TrackLabel {
  std::string name;         ///< the name
  std::string description;  ///< one sentence
  std::string command;      ///< command that generates the same track
};

/// Writes a course folder: map.yaml, map.png, raceline.csv (`# s_m; x_m; ...`), opp_ref_path.csv,
/// course.yaml. Creates the folder if it does not exist. Throws IoError.
void save_track(const GeneratedTrack& track, const std::filesystem::path& folder, const TrackLabel& label);

}  // namespace slalom::vehicle
