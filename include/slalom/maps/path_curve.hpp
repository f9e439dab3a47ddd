#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/reserved_vector.hpp"
#include "slalom/maps/pose.hpp"

namespace slalom::maps {

/// A part of a path between two places where a vehicle stops: it drives one way, or turns on the spot.
struct PathLeg {
  std::size_t first = 0, last = 0;  ///< indices of its points; both are the same for a turn
  bool backward = false;            ///< whether it is driven in reverse
  bool turns = false;               ///< whether the vehicle turns on the spot
  double yaw = 0;                   ///< rad, of the vehicle at its end
};

/// A path as a curve with the progress along it. Points lie at a constant distance. The curve is divided into
/// legs at cusps, where the direction of travel changes between forward and backward, and, for vehicles that
/// turn on the spot, at corners of more than 60 degrees. Progress is local: it never jumps to another leg or
/// to a later pass of the same place. After `reserve` nothing allocates.
class PathCurve {
 public:
  static constexpr double spacing = 0.05;  ///< m, about, between points

  /// Makes room for paths of so many points.
  void reserve(std::size_t count);

  /// Takes the poses of a path, at least one. The yaw of a pose is that of the vehicle on the way to the next
  /// one: it drives backward where the two differ by more than 90 degrees. The yaw of the last pose is that
  /// at the goal; a vehicle that turns on the spot does so there if it arrives with another one. Corners in
  /// the first `smooth` metres do not count.
  void set(std::span<const Pose> poses, bool turns_on_the_spot, double smooth = 0) noexcept;
  /// Starts with a turn on the spot at the first point.
  void turn_first(double yaw) noexcept;
  void clear() noexcept;                                   ///< removes the path
  bool empty() const noexcept { return points_.empty(); }  ///< whether there is none

  /// The points, with the yaw of the vehicle at each.
  std::span<const Pose> points() const noexcept { return points_; }
  const Pose& goal() const noexcept { return goal_; }  ///< the end
  double step() const noexcept { return step_; }       ///< m, between points
  /// The number of points that a length (m) of path takes, rounded up.
  std::size_t points_for(double length) const noexcept {
    return saturate_cast<std::size_t>(length / (step_ > 1e-3 ? step_ : 1e-3)) + 1;
  }

  const PathLeg& leg() const noexcept { return legs_[leg_]; }             ///< the present leg
  bool on_last_leg() const noexcept { return leg_ + 1 == legs_.size(); }  ///< whether it ends at the goal
  void next_leg() noexcept;                                               ///< goes on to the next leg
  /// Drives past the corner at the end of the present leg, without the turn there. Returns false where there
  /// is no corner, or the direction of travel changes.
  bool join_legs() noexcept;
  std::span<const PathLeg> legs() const noexcept { return legs_; }  ///< all legs

  /// Begins at the point of the path that is nearest to the vehicle; where it passes nearly as close several
  /// times, at the first one.
  void place(const Point& vehicle) noexcept;
  /// Moves on to the point nearest to the vehicle, among those of the leg 0.3 m back and 1 m ahead.
  void advance(const Point& vehicle) noexcept;
  std::size_t nearest() const noexcept { return nearest_; }  ///< index of that point
  /// Length of the path from the nearest point on, m.
  double remaining() const noexcept {
    return points_.empty() ? 0 : step_ * static_cast<double>(points_.size() - 1 - nearest_);
  }

 private:
  /// A pose of the path with the way to it (m) and the direction in which it is reached.
  struct Reached {
    std::size_t pose = 0;
    double way = 0, direction = 0;
  };
  void resample(std::span<const Pose> poses) noexcept;
  bool is_boundary(std::size_t i, bool turns_on_the_spot) const noexcept;
  double turn_at(std::size_t i) const noexcept;
  void snap(std::size_t i, std::span<const Pose> poses, Reached& before) noexcept;
  void add_leg(std::size_t first, std::size_t last, bool turns_on_the_spot) noexcept;

  Pose goal_;
  ReservedVector<Pose> points_;
  ReservedVector<std::uint8_t> backward_;  ///< whether the way from each point on is driven in reverse
  ReservedVector<PathLeg> legs_;
  double step_ = spacing;
  std::size_t nearest_ = 0, leg_ = 0;
};

}  // namespace slalom::maps
