#pragma once

#include <optional>

#include "slalom/maps/body_room.hpp"
#include "slalom/maps/path_curve.hpp"

namespace slalom::maps {

/// Tolerances and speeds of a LegFollower.
struct LegOptions {
  double near = 0;      ///< m from its end, where a leg is finished
  double beside = 0;    ///< m from its end, where it is finished once the vehicle is past it or stands; and
                        ///< m beside the leg, where the vehicle may be
  double standing = 0;  ///< m/s, a slower vehicle stands
  double standing_turn = 0;  ///< rad/s, the same of its yaw rate
  bool stops = true;         ///< whether it stands before the next leg begins
  double forwards = 0;       ///< m/s, highest speed forward
  double backwards = 0;      ///< m/s, highest speed backward
  double braking = 0;        ///< m/s^2
  double curvature = 0;      ///< 1/m, highest
  double look_ahead = 0;     ///< m along the leg, of the point to which it drives

  /// For a body of this length (m) that turns with this curvature (1/m). Lengths grow with it, and speeds
  /// with its root. A 1/10-scale car, 0.58 m long, drives at up to 0.8 m/s forward and 0.5 m/s backward.
  static LegOptions of(double length, double curvature);
};

/// Follows the legs of a path: decides where a leg ends and the next one begins, and drives along one.
class LegFollower {
 public:
  /// The measured motion of the vehicle.
  struct Rates {
    double speed = 0;  ///< m/s, whatever its direction
    double turn = 0;   ///< rad/s
  };
  /// The motion that it asks for.
  struct Command {
    double curvature = 0;  ///< 1/m
    double speed = 0;      ///< m/s, negative in reverse
  };

  /// Follows no leg yet.
  explicit LegFollower(const LegOptions& options) : options_(options) {}

  /// Begins the present leg of the path. Of a turn on the spot, `turn` (rad) is to turn.
  void begin(const Pose& vehicle, double turn = 0) noexcept;
  /// Moves on along the path by a period (s). Where a leg is finished, the next one is taken up by
  /// `next()`, which returns the turn (rad) of a turn on the spot.
  template <class Next>
  void update(PathCurve& path, const Pose& vehicle, const Rates& rates, double period, Next&& next) noexcept {
    advance(path, vehicle, rates, period);
    while (!path.on_last_leg() && is_finished(path, vehicle)) {
      path.next_leg();
      begin(vehicle, next());
    }
  }
  double turn_left() const noexcept { return turn_left_; }  ///< the rest of a turn, rad; 0 on other legs
  /// Whether the vehicle has reached the end of the present leg.
  bool is_finished(const PathCurve& path, const Pose& vehicle) const noexcept;

  /// The command of a vehicle at this pose, driving at `speed` (m/s) with wheels of `curvature` (1/m). None
  /// if it is beside the leg, or an obstacle is on it. `room` is in the frame of the vehicle.
  std::optional<Command> command(const PathCurve& path, const Pose& vehicle, double speed, double curvature,
                                 const BodyRoom& room) const noexcept;

 private:
  void advance(PathCurve& path, const Pose& vehicle, const Rates& rates, double period) noexcept;
  double along(const PathCurve& path, const Pose& vehicle) const noexcept;

  LegOptions options_;
  double turn_left_ = 0;  ///< rad
  double last_yaw_ = 0;   ///< rad, of the vehicle
  double standing_ = 0;   ///< s
  double speed_ = 0;      ///< m/s
};

}  // namespace slalom::maps
