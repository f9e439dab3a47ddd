#include <cstdio>
#include <fstream>

#include "slalom/core/error.hpp"
#include "slalom/maps/ros_map.hpp"
#include "slalom/vehicle/course/track_generator.hpp"

namespace slalom::vehicle {
namespace {

namespace fs = std::filesystem;

std::string fixed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  const std::string result = text;
  // "-0.0000" and "0.0000" are the same number and must be the same bytes.
  return result.find_first_of("123456789") == std::string::npos && result.front() == '-' ? result.substr(1)
                                                                                         : result;
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result + '"';
}

void write(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw IoError(file.string(), 0, "cannot be written");
}

std::string raceline_text(const GeneratedTrack& track) {
  std::string text = "# s_m; x_m; y_m; psi_rad; kappa_radpm; vx_mps; ax_mps2\n";
  for (const RacelinePoint& point : track.raceline) {
    for (const double value : {point.arc_length, point.x, point.y, point.yaw, point.curvature, point.speed})
      text += fixed(value, 4) + "; ";
    text += fixed(point.acceleration, 4) + "\n";
  }
  return text;
}

std::string course_text(const GeneratedTrack& track, const TrackLabel& label) {
  const RacelinePoint& first = track.raceline.front();
  return "# Made by `slalom track`; the command below makes it again.\n"
         "name: " +
         quoted(label.name) + "\ndescription: " + quoted(label.description) +
         "\ncommand: " + quoted(label.command) + "\nstart: {x: " + fixed(first.x, 4) +
         ", y: " + fixed(first.y, 4) + ", yaw: " + fixed(first.yaw, 4) + "}\nclosed: true\n";
}

}  // namespace

void save_track(const GeneratedTrack& track, const fs::path& folder, const TrackLabel& label) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder)) throw IoError(folder.string(), 0, "cannot create the folder");
  maps::save_ros_map(track.map, folder / "map.yaml");
  write(folder / "raceline.csv", raceline_text(track));
  std::string obstacles;
  for (const maps::Point& point : track.obstacle_path)
    obstacles += fixed(point.x, 4) + "," + fixed(point.y, 4) + "\n";
  write(folder / "opp_ref_path.csv", obstacles);
  write(folder / "course.yaml", course_text(track, label));
}

}  // namespace slalom::vehicle
