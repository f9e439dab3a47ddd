#include <algorithm>
#include <cmath>

#include "slalom/core/error.hpp"
#include "slalom/maps/ros_map.hpp"
#include "slalom/vehicle/racing/race_course.hpp"
#include "vehicle/course/course_csv.hpp"
#include "vehicle/course/course_text.hpp"

namespace slalom::vehicle {
namespace {

constexpr int decimals = 6;  // curvatures are second differences of the coordinates

}  // namespace

CentreLineFile read_centre_line(const std::filesystem::path& file) {
  bool widths = false;
  auto rows = detail::read_centre_line_rows(file, widths);
  const auto apart = [](const detail::CentreLineRow& a, const detail::CentreLineRow& b) {
    return std::hypot(b.x - a.x, b.y - a.y);
  };
  // Equal points have no direction between them; a last row may repeat the first.
  rows.erase(
      std::unique(rows.begin(), rows.end(), [&](const auto& a, const auto& b) { return apart(a, b) == 0; }),
      rows.end());
  if (rows.size() > 1 && apart(rows.front(), rows.back()) == 0) rows.pop_back();
  if (rows.size() < 4)
    throw IoError(file.string(), 0, std::to_string(rows.size()) + " points; a centre line needs at least 4");
  CentreLineFile read;
  double longest = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0) longest = std::max(longest, apart(rows[i - 1], rows[i]));
    read.line.points.push_back({rows[i].x, rows[i].y});
    if (!widths) continue;
    read.left.push_back(rows[i].left);
    read.right.push_back(rows[i].right);
  }
  read.line.closed = apart(rows.back(), rows.front()) <= 3 * longest;
  return read;
}

void save_race_course(const RaceCourse& course, const std::filesystem::path& folder,
                      const TrackLabel& label) {
  detail::make_folder(folder);
  maps::save_ros_map(course.map, folder / "map.yaml");
  detail::write_file(folder / "raceline.csv", detail::raceline_text(course.raceline.points, decimals));
  const Corridor& corridor = course.corridor;
  std::string text = detail::centre_line_header + std::string("\n");
  for (std::size_t i = 0; i < corridor.centre_line.size(); ++i)
    text += detail::fixed(corridor.centre_line[i].x, decimals) + ", " +
            detail::fixed(corridor.centre_line[i].y, decimals) + ", " +
            detail::fixed(corridor.right[i], decimals) + ", " + detail::fixed(corridor.left[i], decimals) +
            "\n";
  detail::write_file(folder / "centerline.csv", text);
  detail::write_file(folder / "course.yaml",
                     detail::course_text("course", label, course.start, corridor.closed));
}

}  // namespace slalom::vehicle
