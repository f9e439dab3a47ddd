#include "slalom/sim/room/crowd.hpp"

#include <algorithm>
#include <utility>

#include "slalom/core/options.hpp"

namespace slalom::sim {
namespace {

using maps::Point;

// Helbing & Molnar 1995, section III.
constexpr double relaxation = 0.5;            // tau, s
constexpr double others_potential = 2.1;      // V0, m^2/s^2
constexpr double others_range = 0.3;          // sigma, m
constexpr double walls_potential = 10;        // U0, m^2/s^2
constexpr double walls_range = 0.2;           // R, m
constexpr double step_time = 2;               // Delta t, s, of the others' next step
constexpr double out_of_view = 0.5;           // c
constexpr double view = -0.1736481776669303;  // cos(phi), phi = 100 degrees
constexpr double max_speed_ratio = 1.3;       // ratio of the largest speed to v0

constexpr double at_point = 0.3;        // m from a point of the way that is not the last, where it is reached
constexpr double at_end = 0.1;          // m, the same of the last
constexpr double contact = 0.05;        // m from the robot, where nobody attentive steps nearer
constexpr double least_distance = 0.1;  // m, for forces; nearer they would not grow much

Point minus(const Point& a, const Point& b) {
  return {a.x - b.x, a.y - b.y};
}

double length_of(const Point& a) {
  return std::hypot(a.x, a.y);
}

/// The point of a box that is nearest to `to`: `to` itself where that is inside.
Point nearest_of(const Box& box, const Point& to) {
  const Point in = maps::inverse_transform(box.pose, to);
  return maps::transform(box.pose, {std::clamp(in.x, -box.length / 2, box.length / 2),
                                    std::clamp(in.y, -box.width / 2, box.width / 2)});
}

/// Repulsion (m/s^2) from another who walks with `velocity` (m/s), where `apart` (m) leads from the other to
/// the walker (eqs. 3 and 4): minus the gradient of V0 exp(-b / sigma), 2 b = sqrt((|r| + |r - y|)^2 -
/// |y|^2), y = velocity Delta t.
Point from_other(const Point& apart, const Point& velocity) {
  const Point ahead{velocity.x * step_time, velocity.y * step_time}, from_ahead = minus(apart, ahead);
  const double near = std::max(length_of(apart), least_distance),
               far = std::max(length_of(from_ahead), least_distance);
  const double way = length_of(ahead), sum = near + far;
  const double axis = 0.5 * std::sqrt(std::max(sum * sum - way * way, 4 * least_distance * least_distance));
  const double strength = others_potential / others_range * std::exp(-axis / others_range) * sum / (4 * axis);
  return {strength * (apart.x / near + from_ahead.x / far), strength * (apart.y / near + from_ahead.y / far)};
}

/// Repulsion (m/s^2) from a wall, where `apart` (m) leads from its nearest point to the walker (eq. 5).
Point from_wall(const Point& apart) {
  const double distance = std::max(length_of(apart), 1e-3);
  const double strength = walls_potential / walls_range * std::exp(-distance / walls_range) / distance;
  return {strength * apart.x, strength * apart.y};
}

}  // namespace

void Crowd::set_obstacles(const Room& room) {
  solid_ = room.walls;
  solid_.insert(solid_.end(), room.obstacles.begin(), room.obstacles.end());
}

Crowd::Crowd(const Room& room, std::vector<Walker> walkers)
    : length_(room.length), width_(room.width), walkers_(std::move(walkers)) {
  set_obstacles(room);
  for (std::size_t i = 0; i < walkers_.size(); ++i) {
    const Walker& each = walkers_[i];
    const std::string name = "walker " + std::to_string(i);
    const auto check = [&](const char* what, double value, double least, double most) {
      slalom::detail::check(name, {what, "", "", least, most}, value);
    };
    if (each.way.empty()) throw std::invalid_argument(name + ": way: must have at least one point");
    check("speed", each.speed, 0, 3);
    check("radius", each.radius, 0.05, 1);
    check("pause", each.pause, 0, 1000);
    for (const Point& point : each.way)
      for (const double value : {point.x, point.y}) check("way", value, -1e6, 1e6);
    const Disc body{each.way.front(), each.radius};
    check("x of its first point", body.middle.x, each.radius, length_ - each.radius);
    check("y of its first point", body.middle.y, each.radius, width_ - each.radius);
    for (const Box& box : solid_)
      if (signed_gap(box, body) <= 0)
        throw std::invalid_argument(name +
                                    ": first point: must not be within its radius of a wall or an obstacle");
    bodies_.push_back(body);
  }
  velocities_.resize(walkers_.size());
  forces_.resize(walkers_.size());
  directions_.resize(walkers_.size());
  next_.assign(walkers_.size(), 1);
}

/// The direction in which a walker wants to go: of length 1, shorter near the end of its way, 0 while it
/// stands. Moves on to its next point.
Point Crowd::direction_of(std::size_t i) noexcept {
  const Walker& walker = walkers_[i];
  if (time_ < walker.pause) return {};
  while (next_[i] < walker.way.size()) {
    const Point left = minus(walker.way[next_[i]], bodies_[i].middle);
    const double distance = length_of(left);
    const bool is_last = next_[i] + 1 == walker.way.size();
    // A walker slows down near the end of its way, with the time constant of relaxation.
    const double share = is_last && walker.attentive
                             ? std::min(1.0, distance / std::max(walker.speed * relaxation, at_end))
                             : 1;
    if (distance > (is_last ? at_end : at_point))
      return {share * left.x / distance, share * left.y / distance};
    ++next_[i];
  }
  return {};
}

Point Crowd::force_on(std::size_t i, const Box& robot, const Point& robot_velocity) const noexcept {
  const Walker& walker = walkers_[i];
  const Point& here = bodies_[i].middle;
  const Point &wanted = directions_[i], &now = velocities_[i];
  Point sum{(walker.speed * wanted.x - now.x) / relaxation, (walker.speed * wanted.y - now.y) / relaxation};
  if (wanted.x == 0 && wanted.y == 0) return sum;  // it waits or has arrived
  const auto add = [&](const Point& force) { sum = {sum.x + force.x, sum.y + force.y}; };
  // Eq. 8: forces from behind count less.
  const auto add_seen = [&](const Point& force) {
    const double ahead = -(wanted.x * force.x + wanted.y * force.y) / length_of(wanted);
    const double weight = ahead >= length_of(force) * view ? 1 : out_of_view;
    add({weight * force.x, weight * force.y});
  };
  for (std::size_t other = 0; other < bodies_.size(); ++other)
    if (other != i) add_seen(from_other(minus(here, bodies_[other].middle), velocities_[other]));
  add_seen(from_other(minus(here, nearest_of(robot, here)), robot_velocity));
  for (const Box& box : solid_) add(from_wall(minus(here, nearest_of(box, here))));
  add(from_wall({here.x, 0}));
  add(from_wall({here.x - length_, 0}));
  add(from_wall({0, here.y}));
  add(from_wall({0, here.y - width_}));
  return sum;
}

void Crowd::step(double duration, const Box& robot, const Point& velocity) noexcept {
  for (std::size_t i = 0; i < walkers_.size(); ++i) directions_[i] = direction_of(i);
  for (std::size_t i = 0; i < walkers_.size(); ++i)
    forces_[i] = walkers_[i].attentive ? force_on(i, robot, velocity) : Point{};
  for (std::size_t i = 0; i < walkers_.size(); ++i) {
    const Walker& walker = walkers_[i];
    Point& v = velocities_[i];
    if (walker.attentive) {
      v = {v.x + duration * forces_[i].x, v.y + duration * forces_[i].y};
      const double speed = length_of(v), most = max_speed_ratio * walker.speed;
      if (speed > most) v = {v.x * most / speed, v.y * most / speed};
    } else {
      v = {walker.speed * directions_[i].x, walker.speed * directions_[i].y};
    }
    Disc moved{{bodies_[i].middle.x + duration * v.x, bodies_[i].middle.y + duration * v.y}, walker.radius};
    if (walker.attentive) {
      const double gap = signed_gap(robot, moved);
      if (gap < contact && gap < signed_gap(robot, bodies_[i])) {
        v = {};
        continue;
      }
    }
    bodies_[i] = moved;
  }
  time_ += duration;
}

}  // namespace slalom::sim
