#include <algorithm>
#include <cmath>

#include "slalom/core/error.hpp"
#include "slalom/vehicle/racing/race_course.hpp"
#include "vehicle/course/course_csv.hpp"

namespace slalom::vehicle {

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

}  // namespace slalom::vehicle
