#include "tools/recording/driven_line.hpp"

#include <algorithm>
#include <cmath>

#include "slalom/core/error.hpp"
#include "tools/recording/driven_samples.hpp"

namespace slalom::tools {
namespace {

constexpr double spacing = 0.1;  // m between the points that are kept
constexpr double meeting = 1.0;  // m, within which a lap ends where it began
constexpr double min_lap = 10;   // m

}  // namespace

vehicle::GuideLine driven_line(const std::string& file) {
  vehicle::GuideLine line;
  line.closed = false;
  double driven = 0, nearest = meeting;
  std::size_t lap = 0;  // points of the first lap, if one was driven
  for (const vehicle::DrivenSample& sample : read_driven_samples(file)) {
    if (!std::isfinite(sample.x) || !std::isfinite(sample.y)) continue;
    if (!line.points.empty()) {
      const double way = std::hypot(sample.x - line.points.back().x, sample.y - line.points.back().y);
      if (way < spacing) continue;
      driven += way;
    }
    line.points.push_back({sample.x, sample.y});
    const maps::Point& first = line.points.front();
    const double apart = std::hypot(sample.x - first.x, sample.y - first.y);
    if (driven < min_lap) continue;
    if (apart < nearest) {
      nearest = apart;
      lap = line.points.size();
    } else if (lap > 0) {
      break;  // the place where the lap ended is behind
    }
  }
  if (lap > 0) {
    line.closed = true;
    line.points.resize(lap - (nearest < spacing ? 1 : 0));
  }
  if (line.points.size() < 4) throw IoError(file, 0, "must be the recording of a drive of at least 0.4 m");
  return line;
}

}  // namespace slalom::tools
