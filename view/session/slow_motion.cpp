#include "view/session/slow_motion.hpp"

#include <cmath>

namespace slalom::view {
namespace {

constexpr double approaching_rate = 0.5, passing_rate = 0.1;
constexpr double reach = 4;             // m from the car to an obstacle ahead, about the length of a plan
constexpr double beside = 1.5;          // m to either side of the car's axis
constexpr double behind = 0.6;          // m from the centre of a car to that of a car that it has passed
constexpr int max_passing_steps = 120;  // control steps; a car may be blocked

/// Whether a body that does not drive lies ahead of the first car of a world, or beside it.
bool has_obstacle_near(const sim::World& world) noexcept {
  const sim::CarState& car = world.state(0);
  const double c = std::cos(car.yaw), s = std::sin(car.yaw);
  for (std::size_t i = world.cars(); i < world.bodies(); ++i) {
    const maps::Pose body = world.outline(i).pose;
    const double dx = body.x - car.x, dy = body.y - car.y;
    const double ahead = c * dx + s * dy, aside = c * dy - s * dx;
    if (ahead > -behind && ahead < reach && std::abs(aside) < beside) return true;
  }
  return false;
}

}  // namespace

double SlowMotion::rate(std::initializer_list<const sim::World*> worlds) noexcept {
  bool is_near = false;
  for (const sim::World* world : worlds) is_near = is_near || (world != nullptr && has_obstacle_near(*world));
  if (phase_ == Phase::approaching && is_near) phase_ = Phase::passing;
  if (phase_ == Phase::passing && (!is_near || ++steps_ > max_passing_steps)) phase_ = Phase::over;
  return phase_ == Phase::approaching ? approaching_rate : phase_ == Phase::passing ? passing_rate : 1;
}

}  // namespace slalom::view
