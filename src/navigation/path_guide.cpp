#include "navigation/path_guide.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::navigation::detail {

namespace {

constexpr std::size_t max_points = 240;    // points of the window
constexpr double behind = 0.3, ahead = 2;  // m, where the nearest point is searched
constexpr double finest = 0.05;            // m, cells of the map
constexpr double max_cells = 120;          // cells along each side of the map
constexpr double margin = 0.4;             // m of map beyond the reach of plans

/// Field around the robot, over a path as long as a window may be.
maps::ReferenceField make_field(double reach) {
  std::vector<maps::ReferencePoint> path(max_points);
  for (std::size_t i = 0; i < path.size(); ++i)
    path[i] = {PathGuide::spacing * static_cast<double>(i), 0, 0, 0};
  maps::ReferenceFieldOptions options;
  options.length_x = options.length_y = 2 * (reach + margin);
  options.resolution = std::max(finest, options.length_x / max_cells);
  options.points = static_cast<int>(max_points);
  options.points_behind = 0;
  options.spacing = 0;
  return maps::ReferenceField(path, options);
}

}  // namespace

PathGuide::PathGuide(double reach)
    : reach_(reach), field_(make_field(reach)), cells_(field_.geometry().rows, field_.geometry().columns) {
  window_.reserve(max_points);
  cells_.fill({0, 0, 0, 0});
}

void PathGuide::set(std::span<const maps::Point> points, const maps::Pose& goal) noexcept {
  const maps::Point end{goal.x, goal.y};
  const auto at = [&](std::size_t i) { return i < points.size() ? points[i] : end; };
  double length = 0;
  for (std::size_t i = 0; i < points.size(); ++i) length += distance(at(i), at(i + 1));
  const auto parts = saturate_cast<std::size_t>(std::max(2.0, std::ceil(length / spacing)));
  goal_ = goal;
  step_ = length / static_cast<double>(parts);
  nearest_ = 0;
  path_.clear();
  std::size_t segment = 0;
  double begin = 0, here = distance(at(0), at(1));
  for (std::size_t k = 0; k < parts; ++k) {
    const double along = step_ * static_cast<double>(k);
    while (begin + here <= along && segment + 1 < points.size()) {
      begin += here;
      ++segment;
      here = distance(at(segment), at(segment + 1));
    }
    const maps::Point a = at(segment), b = at(segment + 1);
    const double share = here > 0 ? std::min((along - begin) / here, 1.0) : 0;
    path_.push_back({a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), 0});
  }
  path_.push_back({end.x, end.y, 0});
  for (std::size_t i = 0; i + 1 < path_.size(); ++i)
    path_[i].yaw =
        step_ > 0 ? std::atan2(path_[i + 1].y - path_[i].y, path_[i + 1].x - path_[i].x) : goal.yaw;
  path_.back().yaw = path_[path_.size() - 2].yaw;
}

void PathGuide::advance(const maps::Point& robot) noexcept {
  const double step = std::max(step_, 1e-3);
  const auto back = saturate_cast<std::size_t>(behind / step),
             forth = saturate_cast<std::size_t>(ahead / step);
  const std::size_t first = nearest_ > back ? nearest_ - back : 0,
                    last = std::min(nearest_ + forth, path_.size() - 1);
  double least = distance(robot, {path_[nearest_].x, path_[nearest_].y});
  for (std::size_t i = first; i <= last; ++i) {
    const double here = distance(robot, {path_[i].x, path_[i].y});
    if (here >= least) continue;
    least = here;
    nearest_ = i;
  }
}

void PathGuide::write(const maps::Point& robot, NavigationMaps& maps) noexcept {
  // A window that ends where plans cannot come; each of its points holds its index.
  const double step = std::max(step_, 1e-3);
  const auto back = saturate_cast<std::size_t>(behind / step);
  const std::size_t first = nearest_ > back ? nearest_ - back : 0;
  const auto wanted = saturate_cast<std::size_t>((reach_ + margin + behind) / step) + 3;
  const std::size_t available = std::min(wanted, path_.size() - first);
  const std::size_t stride = (available + max_points - 1) / max_points;
  window_.clear();
  for (std::size_t i = 0; i < available; i += stride) {
    const maps::Pose& point = path_[first + i];
    window_.push_back({point.x, point.y, point.yaw, static_cast<double>(window_.size())});
  }
  const std::size_t last = (window_.size() - 1) * stride;
  while (window_.size() < 3) window_.push_back(window_.back());
  field_.set_path(window_);
  field_.update(robot);
  const maps::GridGeometry& geometry = field_.geometry();
  const auto apart = static_cast<float>(step_ * static_cast<double>(stride));
  for (int row = 0; row < geometry.rows; ++row) {
    const float* from = field_.cells().at(row, 0);
    float* to = cells_.at(row, 0);
    for (int column = 0; column < geometry.columns; ++column, from += 4, to += 4) {
      const auto index = saturate_cast<std::size_t>(from[2]);
      to[0] = static_cast<float>(window_[index].x - robot.x);
      to[1] = static_cast<float>(window_[index].y - robot.y);
      to[2] = from[1];
      to[3] = apart * from[2];
    }
  }
  maps.path = cells_.view(geometry);
  maps.origin = robot;
  maps.window_length = step_ * static_cast<double>(last);
  maps.goal_in_window = first + available == path_.size();
  maps.goal = goal_;
}

}  // namespace slalom::navigation::detail
