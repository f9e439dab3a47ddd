#pragma once

#include "slalom/sim/room/room.hpp"

namespace slalom::sim {

/// A walker through a room: a disc that goes from point to point and stops within 0.1 m of the last.
struct Walker {
  std::vector<maps::Point> way;  ///< m; at least one point, the first is the start
  double speed = 1;              ///< m/s, desired speed
  double radius = 0.25;          ///< m
  double pause = 0;              ///< s, before it begins to walk
  /// Whether it avoids others. If not, it walks straight from point to point, through whatever stands there.
  bool attentive = true;
};

/// The people of a room. Attentive ones follow the social force model of D. Helbing & P. Molnar, "Social
/// force model for pedestrian dynamics", Physical Review E 51 (1995) 4282, with the values of its section III
/// and without its attractions and fluctuations, so that the same steps give the same bits:
///
///     dv/dt = (v0 e - v) / tau + sum_b w(f_ab) f_ab + sum_B f_aB,   |v| <= 1.3 v0
///
/// with the desired velocity v0 e towards the next point (eq. 2), the repulsion f_ab from others, whose
/// potential has ellipses as level lines (eqs. 3 and 4), that from walls and obstacles (eq. 5), and the
/// weight w for others out of view (eq. 8).
///
/// The robot counts as one of the others, at the point of its body that is nearest. The model has no contact,
/// so one rule is added: an attentive walker does not step nearer to a robot that is within 0.05 m. So only
/// walkers who are not attentive walk into a robot that stands. A walker who waits or has arrived stands,
/// whoever comes near.
class Crowd {
 public:
  /// In this room, whose walls and obstacles push. Walkers may begin on one another. Throws
  /// std::invalid_argument unless each walker has a way of finite points, a speed in [0, 3], a radius in
  /// [0.05, 1] and a pause in [0, 1000], and begins clear of walls and obstacles.
  Crowd(const Room& room, std::vector<Walker> walkers);

  /// Moves all by `duration` (s), at most 0.05 for the forces to be followed. `robot` is the robot's body,
  /// and `velocity` (m/s, map frame) that of its middle.
  void step(double duration, const Box& robot, const maps::Point& velocity) noexcept;

  /// Replaces the walls and obstacles that push by those of another room.
  void set_obstacles(const Room& room);

  /// The bodies, in the order of the walkers.
  std::span<const Disc> bodies() const noexcept { return bodies_; }
  std::span<const maps::Point> velocities() const noexcept { return velocities_; }  ///< their velocities, m/s

 private:
  maps::Point force_on(std::size_t i, const Box& robot, const maps::Point& robot_velocity) const noexcept;
  maps::Point direction_of(std::size_t i) noexcept;

  double length_, width_;   ///< m, of the floor
  std::vector<Box> solid_;  ///< walls and obstacles
  std::vector<Walker> walkers_;
  std::vector<Disc> bodies_;
  std::vector<maps::Point> velocities_, forces_, directions_;
  std::vector<std::size_t> next_;  ///< the point to which each walks; the number of points once it is there
  double time_ = 0;                ///< s
};

}  // namespace slalom::sim
