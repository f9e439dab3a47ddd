#include "vehicle/course/course_text.hpp"

#include <cstdio>
#include <fstream>

#include "slalom/core/error.hpp"

namespace slalom::vehicle::detail {
namespace {

namespace fs = std::filesystem;

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result + '"';
}

}  // namespace

std::string fixed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  const std::string result = text;
  // "-0.0000" and "0.0000" are the same number and must be the same bytes.
  return result.find_first_of("123456789") == std::string::npos && result.front() == '-' ? result.substr(1)
                                                                                         : result;
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder)) throw IoError(folder.string(), 0, "cannot create the folder");
}

void write_file(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw IoError(file.string(), 0, "cannot be written");
}

std::string raceline_text(const std::vector<RacelinePoint>& raceline, int digits) {
  std::string text = "# s_m; x_m; y_m; psi_rad; kappa_radpm; vx_mps; ax_mps2\n";
  for (const RacelinePoint& point : raceline) {
    for (const double value : {point.arc_length, point.x, point.y, point.yaw, point.curvature, point.speed})
      text += fixed(value, digits) + "; ";
    text += fixed(point.acceleration, digits) + "\n";
  }
  return text;
}

std::string course_text(const std::string& maker, const TrackLabel& label, const maps::Pose& start,
                        bool closed) {
  return "# Made by `slalom " + maker + "`; the command below makes it again.\nname: " + quoted(label.name) +
         "\ndescription: " + quoted(label.description) + "\ncommand: " + quoted(label.command) +
         "\nstart: {x: " + fixed(start.x, 4) + ", y: " + fixed(start.y, 4) + ", yaw: " + fixed(start.yaw, 4) +
         "}\nclosed: " + (closed ? "true" : "false") + "\n";
}

}  // namespace slalom::vehicle::detail
