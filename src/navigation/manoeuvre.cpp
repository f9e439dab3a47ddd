#include "navigation/manoeuvre.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::navigation::detail {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double spacing = 0.05;       // m, between poses
constexpr double price_of_cusp = 0.5;  // m

/// The pose after driving a length along a part.
maps::Pose after(const maps::Pose& from, double length, int steering, double radius) {
  if (steering == 0)
    return {from.x + length * std::cos(from.yaw), from.y + length * std::sin(from.yaw), from.yaw};
  const double yaw = from.yaw + steering * length / radius, side = steering * radius;
  return {from.x + side * (std::sin(yaw) - std::sin(from.yaw)),
          from.y - side * (std::cos(yaw) - std::cos(from.yaw)), yaw};
}

/// Calls `visit(pose)` for poses along a manoeuvre, without the last one, until it returns false.
template <class Visit>
bool visit_poses(const Manoeuvre& manoeuvre, maps::Pose from, Visit&& visit) {
  for (const Manoeuvre::Part& part : manoeuvre.parts) {
    const int steps = saturate_cast<int>(std::ceil(std::abs(part.length) / spacing));
    for (int i = 0; i < steps; ++i)
      if (!visit(after(from, part.length * i / steps, part.steering, manoeuvre.radius))) return false;
    from = after(from, part.length, part.steering, manoeuvre.radius);
  }
  return true;
}

/// The angles of the three parts of a word, in units of the radius; of arcs from -pi to pi.
struct Word {
  bool exists = false;
  double t = 0, u = 0, v = 0;
  int second = 0, third = 1;  ///< steering; that of the first part is 1
};

/// Left, straight, left.
Word left_straight_left(double x, double y, double yaw) {
  const double dx = x - std::sin(yaw), dy = y - 1 + std::cos(yaw), t = std::atan2(dy, dx);
  return {true, t, std::hypot(dx, dy), maps::wrap_angle(yaw - t), 0, 1};
}

/// Left, straight, right.
Word left_straight_right(double x, double y, double yaw) {
  const double dx = x + std::sin(yaw), dy = y - 1 - std::cos(yaw), squared = dx * dx + dy * dy;
  if (squared < 4) return {};
  const double u = std::sqrt(squared - 4);
  const double t = maps::wrap_angle(std::atan2(dy, dx) + std::atan2(2.0, u));
  return {true, t, u, maps::wrap_angle(t - yaw), 0, -1};
}

/// Left, right in the other direction, left again.
Word left_right_left(double x, double y, double yaw) {
  const double dx = x - std::sin(yaw), dy = y - 1 + std::cos(yaw), length = std::hypot(dx, dy);
  if (length > 4) return {};
  const double u = -2 * std::asin(length / 4);
  const double t = maps::wrap_angle(std::atan2(dy, dx) + u / 2 + pi);
  return {true, t, u, maps::wrap_angle(yaw - t + u), -1, 1};
}

}  // namespace

double Manoeuvre::cost() const noexcept {
  double sum = 0, before = 0;
  for (const Part& part : parts) {
    sum += std::abs(part.length) + (part.length * before < 0 ? price_of_cusp : 0);
    if (part.length != 0) before = part.length;
  }
  return sum;
}

void Manoeuvre::append(const maps::Pose& from, std::vector<maps::Pose>& poses) const noexcept {
  visit_poses(*this, from, [&](const maps::Pose& pose) {
    if (poses.size() < poses.capacity()) poses.push_back(pose);
    return true;
  });
}

bool Manoeuvre::is_free(const maps::Pose& from, const Costmap& costmap,
                        const Footprint& footprint) const noexcept {
  return visit_poses(*this, from, [&](const maps::Pose& pose) { return !costmap.collides(footprint, pose); });
}

Manoeuvre find_manoeuvre(const maps::Pose& from, const maps::Pose& to, const Manoeuvre::Limits& limits,
                         double most, const Costmap& costmap, const Footprint& footprint) noexcept {
  const double radius = limits.radius;
  const maps::Point relative = maps::inverse_transform(from, {to.x, to.y});
  const double x = relative.x / radius, y = relative.y / radius, yaw = maps::wrap_angle(to.yaw - from.yaw);
  Manoeuvre best;
  best.parts[0].length = std::numeric_limits<double>::infinity();
  double least = most;
  // Mirrored in time, the base drives the other way; mirrored in space, it steers to the other side.
  for (const int way : {1, -1})
    for (const int side : {1, -1}) {
      const double at_x = way * x, at_y = side * y, at_yaw = way * side * yaw;
      for (const auto& word : {left_straight_left, left_straight_right, left_right_left}) {
        const Word found = word(at_x, at_y, at_yaw);
        if (!found.exists) continue;
        const double scale = way * radius;
        const Manoeuvre made{{{{scale * found.t, side},
                               {scale * found.u, side * found.second},
                               {scale * found.v, side * found.third}}},
                             radius};
        const double cost = made.cost();
        if (!limits.can_reverse && std::any_of(made.parts.begin(), made.parts.end(),
                                               [](const Manoeuvre::Part& part) { return part.length < 0; }))
          continue;
        if (cost >= least || !made.is_free(from, costmap, footprint)) continue;
        least = cost;
        best = made;
      }
    }
  return best;
}

}  // namespace slalom::navigation::detail
