#include "navigation/path_guide.hpp"

namespace slalom::navigation::detail {
namespace {

constexpr int max_points = 240;     // points of the window
constexpr double behind = 0.3;      // m of the window behind the robot
constexpr double margin = 0.4;      // m of it beyond the reach of plans
constexpr double least_way = 1e-3;  // m between poses, below which there is no direction
constexpr double aligned = 0.5;     // cosine of the largest angle between yaws that count and the path

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
    if (distance(position(path[i]), position(path[i + 1])) > least_way &&
        std::abs(agreement(path, i)) < aligned)
      return false;
  return true;
}

}  // namespace

void set_yaws(std::span<maps::Pose> path, const BaseOptions& base) noexcept {
  const bool given = base.max_reverse > 0 && yaws_count(path),
             reverses_at_cusps = base.max_reverse > 0 && base.kind == BaseKind::ackermann;
  bool backward = false, begun = false;
  double before = 0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    if (distance(position(path[i]), position(path[i + 1])) > least_way) {
      const double along = direction(path[i], path[i + 1]);
      if (given) {
        backward = agreement(path, i) < 0;
      } else if (reverses_at_cusps && begun && std::cos(along - before) < -aligned) {
        backward = !backward;
      }
      before = along;
      begun = true;
    }
    if (begun) path[i].yaw = before + (backward ? std::numbers::pi : 0);
  }
}

PathGuide::PathGuide(double reach) : reach_(reach), cells_(1, max_points) {
  cells_.fill({0, 0, 0, 0});
}

void PathGuide::write(const maps::Pose& robot, double left, std::size_t stop, NavigationMaps& maps) noexcept {
  const maps::PathLeg& at = leg();
  const double spacing_here = std::max(step(), 1e-3);
  const auto back = saturate_cast<std::size_t>(behind / spacing_here);
  const std::size_t first = std::max(at.first, nearest() > back ? nearest() - back : 0);
  const auto wanted = first + saturate_cast<std::size_t>((reach_ + margin + behind) / spacing_here) + 3;
  const std::size_t last = std::max(first, std::min({wanted, at.last, stop}));
  const std::size_t stride = (last - first) / max_points + 1;
  const double turned = at.backward ? std::numbers::pi : 0;
  // Storage holds a ring of cells, which have the values of the first and of the last point.
  for (int column = -1; column <= max_points; ++column) {
    const std::size_t i = std::min(first + std::max(column, 0) * stride, last);
    const maps::Pose& point = points()[i];
    const double yaw = (i == at.last && i > at.first ? points()[i - 1].yaw : point.yaw) + turned;
    for (int row = -1; row <= 1; ++row) {
      float* const to = cells_.at(row, column);
      to[0] = static_cast<float>(point.x - robot.x);
      to[1] = static_cast<float>(point.y - robot.y);
      to[2] = static_cast<float>(yaw);
      to[3] = static_cast<float>(step() * (i - first));
    }
  }
  const double apart = spacing_here * stride;
  const maps::GridGeometry geometry{1, max_points, apart, 0, -0.5 * apart * (max_points - 1)};
  const maps::Pose &near = points()[nearest()], &end = points()[last];
  maps.path = cells_.view(geometry);
  maps.origin = {robot.x, robot.y};
  maps.window_length = step() * (last - first);
  const double along =
      std::cos(near.yaw + turned) * (robot.x - near.x) + std::sin(near.yaw + turned) * (robot.y - near.y);
  maps.progress = std::clamp(step() * (nearest() - first) + along, 0.0, maps.window_length);
  maps.backward = at.backward;
  maps.turns = at.turns;
  maps.ends_leg = last == at.last;
  maps.ends_at_goal = last + 1 == points().size();
  // The robot's yaw is not wrapped in rollouts.
  maps.end = {end.x, end.y, robot.yaw + (at.turns ? left : maps::wrap_angle(goal().yaw - robot.yaw))};
}

}  // namespace slalom::navigation::detail
