#include "navigation/path_yaws.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slalom::navigation::detail {

namespace {

constexpr double least_way = 1e-3;    // m between poses, below which there is no direction
constexpr double aligned = 0.5;       // cosine of the largest angle between yaws that count and the path
constexpr double cusp_cosine = -0.5;  // cosine of the change of direction at a cusp, at most

bool is_way(const maps::Pose& a, const maps::Pose& b) {
  return std::hypot(b.x - a.x, b.y - a.y) > least_way;
}

double direction(const maps::Pose& a, const maps::Pose& b) {
  return std::atan2(b.y - a.y, b.x - a.x);
}

/// How far the yaws at the ends of a way agree with its direction: near 1, or near -1 in reverse. The yaw of
/// the path's last pose is that of the goal.
double agreement(std::span<const maps::Pose> path, std::size_t i) {
  const double along = direction(path[i], path[i + 1]);
  const double begin = std::cos(path[i].yaw - along), end = std::cos(path[i + 1].yaw - along);
  return i + 2 == path.size() || std::abs(begin) >= std::abs(end) ? begin : end;
}

/// Whether the yaws but the last, which is that of the goal, are those of a vehicle on the path. Planners
/// that do not fill them in leave all the same.
bool yaws_count(std::span<const maps::Pose> path) {
  const auto differs = [&](const maps::Pose& pose) { return pose.yaw != path.front().yaw; };
  if (std::none_of(path.begin(), path.end() - 1, differs)) return false;
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    if (is_way(path[i], path[i + 1]) && std::abs(agreement(path, i)) < aligned) return false;
  return true;
}

}  // namespace

void set_yaws(std::span<maps::Pose> path, const BaseOptions& base) noexcept {
  const bool given = base.max_reverse > 0 && yaws_count(path),
             reverses_at_cusps = base.max_reverse > 0 && base.kind == BaseKind::ackermann;
  bool backward = false, begun = false;
  double before = 0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    if (is_way(path[i], path[i + 1])) {
      const double along = direction(path[i], path[i + 1]);
      if (given) {
        backward = agreement(path, i) < 0;
      } else if (reverses_at_cusps && begun && std::cos(along - before) < cusp_cosine) {
        backward = !backward;
      }
      before = along;
      begun = true;
    }
    if (begun) path[i].yaw = before + (backward ? std::numbers::pi : 0);
  }
}

void set_straight(std::vector<maps::Pose>& path, const maps::Pose& robot, const maps::Pose& goal,
                  const BaseOptions& base) noexcept {
  path.assign({robot, goal});
  if (base.max_reverse == 0) path[0].yaw = direction(robot, goal);
}

}  // namespace slalom::navigation::detail
