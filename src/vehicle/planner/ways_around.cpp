#include "vehicle/planner/ways_around.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::vehicle::detail {

namespace {

constexpr double gravity = 9.81;                        // m/s^2
constexpr double side_step = 0.75;                      // car widths from one way to the next
constexpr double slow_speeds[] = {1.5, 3, 1e3};         // m/s at most
constexpr double turning_share = 0.6;                   // of the usable grip
constexpr double braking = 0.8, accelerating = 0.5;     // of the largest deceleration and acceleration
constexpr double look_ahead = 0.4, min_wheelbases = 2;  // s, and wheelbases on top of it

double distance(const maps::ReferencePoint& point, double x, double y) {
  return std::hypot(point.x - x, point.y - y);
}

}  // namespace

/// A car on its way, as the kinematic bicycle.
struct WaysAround::Car {
  double x, y, yaw, speed;
  std::size_t at;  ///< nearest point of the path
};

WaysAround::WaysAround(std::span<const maps::ReferencePoint> path, bool closed, int horizon, int inputs,
                       const VehicleTraits& traits, double steer_limit)
    : path_(path.begin(), path.end()),
      closed_(closed),
      traits_(traits),
      steepest_(std::tan(steer_limit)),
      batch_(horizon, inputs, count),
      costs_(batch_.stride()),
      collided_(static_cast<std::size_t>(batch_.stride())),
      inputs_(static_cast<std::size_t>(batch_.rows())) {}

void WaysAround::draw(const VehicleStart& start, int nearest, std::span<const double> path_speeds,
                      double friction) noexcept {
  const Car car{start.pose.x, start.pose.y, start.pose.yaw, std::max(start.speed, 0.0),
                static_cast<std::size_t>(nearest)};
  for (int way = 0; way < count; ++way)
    draw_way(way, car, path_speeds, turning_share * traits_.usable_grip * friction * gravity);
}

void WaysAround::draw_way(int way, Car car, std::span<const double> path_speeds, double grip) noexcept {
  const int side = way / WaysAround::speeds - sides;
  const double offset = side * side_step * traits_.body.width;
  const double fastest = slow_speeds[way % WaysAround::speeds], dt = traits_.time_step;
  for (int k = 0; k < batch_.steps(); ++k) {
    for (std::size_t next = car.at;
         advance(next) && distance(path_[next], car.x, car.y) < distance(path_[car.at], car.x, car.y);)
      car.at = next;
    const double slope = steering_to(car, offset),
                 most = std::min(grip / std::max(car.speed * car.speed, 1e-3) * traits_.wheelbase, steepest_);
    const double steer = std::atan(std::clamp(slope, -most, most));
    const double wanted = (std::min(path_speeds[car.at], fastest) - car.speed) / dt;
    const double acceleration =
        std::clamp(wanted, -braking * traits_.max_deceleration, accelerating * traits_.max_acceleration);
    const double share = car.speed / traits_.half_steer_speed;
    batch_.at(k, 0, way) = static_cast<float>(steer * (1 + share * share));
    batch_.at(k, 1, way) = static_cast<float>(acceleration);
    const double driven = std::max(car.speed + 0.5 * acceleration * dt, 0.0) * dt;
    const double turned = driven * std::tan(steer) / traits_.wheelbase;
    car.x += driven * std::cos(car.yaw + 0.5 * turned);
    car.y += driven * std::sin(car.yaw + 0.5 * turned);
    car.yaw += turned;
    car.speed = std::max(car.speed + acceleration * dt, 0.0);
  }
}

/// The tangent of the wheels' angle that leads, on a circle, to the line `offset` m left of the path (pure
/// pursuit; Coulter, CMU-RI-TR-92-01, 1992).
double WaysAround::steering_to(const Car& car, double offset) const noexcept {
  const double ahead = look_ahead * car.speed + min_wheelbases * traits_.wheelbase;
  std::size_t to = car.at;
  for (double way = 0; way < ahead;) {
    const std::size_t before = to;
    if (!advance(to)) break;
    way += distance(path_[to], path_[before].x, path_[before].y);
  }
  const double x = path_[to].x - offset * std::sin(path_[to].yaw) - car.x,
               y = path_[to].y + offset * std::cos(path_[to].yaw) - car.y;
  const double left = y * std::cos(car.yaw) - x * std::sin(car.yaw);
  return 2 * traits_.wheelbase * left / std::max(x * x + y * y, 1e-6);
}

/// Moves to the next point of the path; false at the end of one that is not closed.
bool WaysAround::advance(std::size_t& at) const noexcept {
  if (!closed_ && at + 1 == path_.size()) return false;
  at = (at + 1) % path_.size();
  return true;
}

std::span<const float> WaysAround::cheapest(const BatchEvaluator& evaluator) noexcept {
  evaluator.evaluate(batch_, 0, count, costs_.data(), collided_.data());
  int best = -1;
  for (int way = 0; way < count; ++way)
    if (std::isfinite(costs_[way]) && (best < 0 || costs_[way] < costs_[best])) best = way;
  if (best < 0) return {};
  batch_.get_sample(best, inputs_);
  return inputs_;
}

}  // namespace slalom::vehicle::detail
