#pragma once

#include "slalom/core/grid_view.hpp"
#include "slalom/core/problem.hpp"
#include "slalom/core/simd.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/vehicle/model/path_tracking_options.hpp"

namespace slalom::vehicle {

/// The cost map value of the car's body at a pose: 100 in collision, less near one, negative off the map.
class ObstacleCost {
 public:
  /// Takes the options of the body.
  explicit ObstacleCost(const BodyOptions& options);

  /// The clearance up to which a map for discs must be right, m.
  static double clearance_reach(const BodyOptions& options);

  /// The map of obstacles in the frame of the robot at `robot` (map frame). For a box it is the cost map (0
  /// free, 100 occupied), for discs the map of clearances (m, up to `clearance_reach`). Its ring is negative.
  void set_map(const GridView<1>& obstacles, const maps::Pose& robot) noexcept;

  /// Counts collisions up to this share (0 to 1) of the margin around the body, and nearness up to this share
  /// (above 0) of the soft margin. It matters with discs alone: the map for a box has its margins in it.
  void set_margin_shares(double margin, double soft) noexcept;

  /// The robot's pose at the time of the scan, map frame.
  const maps::Pose& robot() const noexcept { return robot_; }

  /// The value at a pose in the map frame: m, m, rad.
  template <class T>
  SLALOM_INLINE T in_map_frame(const T& x, const T& y, const T& yaw) const {
    if (discs_) {
      T sine, cosine;
      sin_cos(yaw, sine, cosine);
      return disc_value(min_clearance(T(to_local_[0]) * x + (T(to_local_[1]) * y + T(to_local_[2])),
                                      T(to_local_[3]) * x + (T(to_local_[4]) * y + T(to_local_[5])),
                                      T(to_local_[0]) * cosine + T(to_local_[1]) * sine,
                                      T(to_local_[3]) * cosine + T(to_local_[4]) * sine));
    }
    if constexpr (is_pack<T>) {
      // One step from the map frame to cells.
      return look_up_cell(obstacles_, T(to_cells_[0]) * x + (T(to_cells_[1]) * y + T(to_cells_[2])),
                          T(to_cells_[3]) * x + (T(to_cells_[4]) * y + T(to_cells_[5])));
    } else {
      return slalom::look_up(obstacles_, T(to_local_[0]) * x + (T(to_local_[1]) * y + T(to_local_[2])),
                             T(to_local_[3]) * x + (T(to_local_[4]) * y + T(to_local_[5])));
    }
  }

  /// m, how far the point of `blocked` is ahead of the rear axle: the foremost disc's centre; with a box 0.
  double foremost() const noexcept { return discs_ ? double(disc_[2]) : 0; }

  /// Whether the body collides with the point of `foremost` at a position in the map frame, m: with discs the
  /// foremost one, with a box all of it in its heading at the time of the scan. Off the map nothing collides.
  template <class T>
  SLALOM_INLINE mask_t<T> blocked(const T& x, const T& y) const {
    const T value = slalom::look_up(obstacles_, T(to_local_[0]) * x + (T(to_local_[1]) * y + T(to_local_[2])),
                                    T(to_local_[3]) * x + (T(to_local_[4]) * y + T(to_local_[5])));
    if (!discs_) return mask_t<T>(value >= T(100));
    return mask_t<T>((value >= T(0)) & (value < T(collision_clearance_)));
  }

  /// The value at a pose in the robot's frame: m, m, rad.
  template <class T>
  SLALOM_INLINE T in_robot_frame(const T& x, const T& y, const T& yaw) const {
    if (discs_) {
      T sine, cosine;
      sin_cos(yaw, sine, cosine);
      return disc_value(min_clearance(x, y, cosine, sine));
    }
    return slalom::look_up(obstacles_, x, y);
  }

  /// Whether the body collides at `from`, or on a straight way from there to `to` (map frame) on which it
  /// turns evenly, the shorter way round, but for its end.
  bool collides_before(const maps::Pose& from, const maps::Pose& to) const noexcept;

  /// The way (m) that the body can go from a pose in the map frame without a collision; below 0 in one.
  double room(const maps::Pose& pose) const noexcept;

 private:
  /// The least clearance of the discs' centres, m.
  template <class T>
  SLALOM_INLINE T min_clearance(const T& x, const T& y, const T& heading_x, const T& heading_y) const {
    T least = slalom::look_up(obstacles_, x + T(disc_[0]) * heading_x, y + T(disc_[0]) * heading_y);
    least = min(least, slalom::look_up(obstacles_, x + T(disc_[1]) * heading_x, y + T(disc_[1]) * heading_y));
    return min(least, slalom::look_up(obstacles_, x + T(disc_[2]) * heading_x, y + T(disc_[2]) * heading_y));
  }
  template <class T>
  SLALOM_INLINE T disc_value(const T& clearance) const {
    const T nearness = max((T(soft_end_) - clearance) * T(inverse_soft_margin_), T(0));
    const T value = select(clearance < T(collision_clearance_), T(100), T(soft_cost_) * nearness * nearness);
    return select(clearance < T(0), T(-1), value);
  }

  GridView<1> obstacles_;
  maps::Pose robot_;
  bool discs_;
  double radius_, margin_, soft_margin_;          ///< m, of a disc, and around it
  double to_local_[6] = {1, 0, 0, 0, 1, 0};       ///< m in the map frame -> m in the robot's
  Coefficient to_cells_[6] = {1, 0, 0, 0, 1, 0};  ///< m in the map frame -> cells of the cost map
  Coefficient disc_[3];                           ///< m, centres of the discs ahead of the rear axle
  Coefficient collision_clearance_;               ///< m from a disc's centre
  Coefficient soft_end_;                          ///< m from a disc's centre
  Coefficient inverse_soft_margin_;               ///< 1/m
  Coefficient soft_cost_;
};

}  // namespace slalom::vehicle
