#include "vehicle/planner/ways_around.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slalom/core/gravity.hpp"
#include "slalom/core/math.hpp"

namespace slalom::vehicle::detail {

/// A kinematic bicycle that drives one of the ways.
struct WaysAround::Bicycle {
  double x, y, yaw, speed;
  std::size_t at;           // nearest point of the path
  std::size_t to;           // the point that it steers to
  double way;               // m along the path, from `at` to `to`
  double ahead_x, ahead_y;  // the direction of the car's axis

  void turn(double angle) noexcept {
    yaw += angle;
    ahead_x = std::cos(yaw);
    ahead_y = std::sin(yaw);
  }
  /// Drives for `dt` (s), with half of the turn before the way and half after it.
  void drive(double acceleration, double steer_tangent, double wheelbase, double dt) noexcept {
    const double driven = std::max(speed + 0.5 * acceleration * dt, 0.0) * dt;
    const double half_turn = 0.5 * driven * steer_tangent / wheelbase;
    turn(half_turn);
    x += driven * ahead_x;
    y += driven * ahead_y;
    turn(half_turn);
    speed = std::max(speed + acceleration * dt, 0.0);
  }
};
WaysAround::WaysAround(std::span<const maps::ReferencePoint> path, bool closed, int horizon, int inputs,
                       const VehicleTraits& traits, double steer_limit)
    : closed_(closed),
      traits_(traits),
      limits_{CarScale::of(traits.body)},
      steepest_(std::tan(steer_limit)),
      batch_(horizon, inputs, count),
      costs_(batch_.stride()),
      collided_(static_cast<std::size_t>(batch_.stride())),
      inputs_(static_cast<std::size_t>(batch_.rows())) {
  for (std::size_t i = 0; i < path.size(); ++i) {
    const maps::ReferencePoint &here = path[i], &next = path[(i + 1) % path.size()];
    path_.push_back({here.x, here.y, -std::sin(here.yaw), std::cos(here.yaw),
                     std::hypot(next.x - here.x, next.y - here.y)});
  }
}

void WaysAround::draw(const VehicleStart& start, int nearest, std::span<const double> path_speeds,
                      double friction) noexcept {
  const auto at = static_cast<std::size_t>(nearest);
  Bicycle car{start.pose.x, start.pose.y, 0, std::max(start.speed, 0.0), at, at, 0, 1, 0};
  car.turn(start.pose.yaw);
  for (int way = 0; way < count; ++way)
    draw_way(way, car, path_speeds, turning_share * traits_.tyres.usable_grip * friction * gravity);
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

void WaysAround::draw_way(int way, Bicycle car, std::span<const double> path_speeds, double grip) noexcept {
  const double offset = (way / speeds - sides) * side_step * traits_.body.width;
  const double top_speeds[] = {limits_.slow, 2 * limits_.slow, std::numeric_limits<double>::infinity()};
  const double fastest = top_speeds[way % speeds], dt = traits_.time_step;
  for (int k = 0; k < batch_.steps(); ++k) {
    look_ahead(car);
    const double most = std::min(grip / std::max(car.speed * car.speed, 1e-3) * traits_.wheelbase, steepest_);
    const double tangent = std::clamp(steering_to(car, offset), -most, most);
    const double wanted = (std::min(path_speeds[car.at], fastest) - car.speed) / dt;
    const double acceleration =
        std::clamp(wanted, -braking * traits_.max_deceleration, accelerating * traits_.max_acceleration);
    const double share = car.speed / traits_.tyres.half_steer_speed;
    batch_.at(k, 0, way) = static_cast<float>(std::atan(tangent) * (1 + share * share));
    batch_.at(k, 1, way) = static_cast<float>(acceleration);
    car.drive(acceleration, tangent, traits_.wheelbase, dt);
  }
}

/// Updates the car's two points of the path: the nearest one, and the one to steer to.
void WaysAround::look_ahead(Bicycle& car) const noexcept {
  const auto squared_distance = [&](std::size_t i) {
    return square(path_[i].x - car.x) + square(path_[i].y - car.y);
  };
  for (std::size_t next = car.at; advance(next) && squared_distance(next) < squared_distance(car.at);) {
    car.way -= path_[car.at].gap;
    car.at = next;
  }
  const double ahead = limits_.look_ahead_time * car.speed + min_wheelbases * traits_.wheelbase;
  // A slower car looks less far ahead, so the point may move back.
  const std::size_t points = path_.size();
  for (std::size_t before; car.to != car.at; car.to = before) {
    before = (car.to + points - 1) % points;
    if (car.way - path_[before].gap < ahead) break;
    car.way -= path_[before].gap;
  }
  while (car.way < ahead) {
    const double gap = path_[car.to].gap;
    if (!advance(car.to)) break;
    car.way += gap;
  }
}

/// Returns the tangent of the wheels' angle for a circle to the point `offset` m left of the path (pure
/// pursuit; Coulter, CMU-RI-TR-92-01, 1992).
double WaysAround::steering_to(const Bicycle& car, double offset) const noexcept {
  const PathNormal& to = path_[car.to];
  const double x = to.x + offset * to.left_x - car.x, y = to.y + offset * to.left_y - car.y;
  const double left = y * car.ahead_x - x * car.ahead_y;
  return 2 * traits_.wheelbase * left / std::max(x * x + y * y, 1e-6);
}

/// Moves to the next point of the path. Returns false at the end of an open path.
bool WaysAround::advance(std::size_t& at) const noexcept {
  if (!closed_ && at + 1 == path_.size()) return false;
  at = (at + 1) % path_.size();
  return true;
}

}  // namespace slalom::vehicle::detail
