#include "navigation/path_guide.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slalom::navigation::detail {

namespace {

constexpr int max_points = 240;  // points of the window
constexpr double behind = 0.3;   // m of the window behind the robot
constexpr double margin = 0.4;   // m of it beyond the reach of plans

}  // namespace

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
  const std::size_t stride = (last - first) / static_cast<std::size_t>(max_points) + 1;
  const double turned = at.backward ? std::numbers::pi : 0;
  // Storage holds a ring of cells, which have the values of the first and of the last point.
  for (int column = -1; column <= max_points; ++column) {
    const std::size_t i = std::min(first + static_cast<std::size_t>(std::max(column, 0)) * stride, last);
    const maps::Pose& point = points()[i];
    const double yaw = (i == at.last && i > at.first ? points()[i - 1].yaw : point.yaw) + turned;
    for (int row = -1; row <= 1; ++row) {
      float* const to = cells_.at(row, column);
      to[0] = static_cast<float>(point.x - robot.x);
      to[1] = static_cast<float>(point.y - robot.y);
      to[2] = static_cast<float>(yaw);
      to[3] = static_cast<float>(step() * static_cast<double>(i - first));
    }
  }
  const double apart = spacing_here * static_cast<double>(stride);
  const maps::GridGeometry geometry{1, max_points, apart, 0, -0.5 * apart * (max_points - 1)};
  const maps::Pose &near = points()[nearest()], &end = points()[last];
  maps.path = cells_.view(geometry);
  maps.origin = {robot.x, robot.y};
  maps.window_length = step() * static_cast<double>(last - first);
  const double along =
      std::cos(near.yaw + turned) * (robot.x - near.x) + std::sin(near.yaw + turned) * (robot.y - near.y);
  maps.progress =
      std::clamp(step() * static_cast<double>(nearest() - first) + along, 0.0, maps.window_length);
  maps.backward = at.backward;
  maps.turns = at.turns;
  maps.ends_leg = last == at.last;
  maps.ends_at_goal = last + 1 == points().size();
  // The robot's yaw is not wrapped in rollouts.
  maps.end = {end.x, end.y, robot.yaw + (at.turns ? left : maps::wrap_angle(goal().yaw - robot.yaw))};
}

}  // namespace slalom::navigation::detail
