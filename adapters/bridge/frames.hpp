#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>

#include "bridge/bridge.hpp"

/// Times and coordinate frames, as the cores of the nodes see them.
namespace slalom_bridge {

/// ns, a time of the clock of the stamps; 0: none. A transform can be looked up at exactly this time.
using Stamp = std::int64_t;

/// s.
inline double in_seconds(Stamp stamp) {
  return 1e-9 * static_cast<double>(stamp);
}
/// The nearest stamp to a time (s).
inline Stamp stamp_of(double seconds) {
  return static_cast<Stamp>(std::llround(1e9 * seconds));
}

/// Where a sensor is: the pose of its frame in the base frame.
struct Mount {
  double rotation[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  ///< from the sensor's axes to those of the base
  double x = 0, y = 0, z = 0;                                 ///< m

  /// The pose in the plane.
  Pose planar() const { return {x, y, std::atan2(rotation[1][0], rotation[0][0])}; }
  /// Whether its z axis points upwards, to within 25 degrees.
  bool upright() const { return rotation[2][2] > 0.9; }
};

/// From a translation (m) and a unit quaternion.
inline Mount mount_of(double x, double y, double z, double qx, double qy, double qz, double qw) {
  return {{{1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qw * qz), 2 * (qx * qz + qw * qy)},
           {2 * (qx * qy + qw * qz), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qw * qx)},
           {2 * (qx * qz - qw * qy), 2 * (qy * qz + qw * qx), 1 - 2 * (qx * qx + qy * qy)}},
          x,
          y,
          z};
}

/// The component along an axis of the base (0: x, ahead; 1: y, to the left; 2: z) of a vector along the
/// sensor's axes.
inline double along(int axis, const Mount& mount, const double (&vector)[3]) {
  const double(&row)[3] = mount.rotation[axis];
  return row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2];
}

/// The transforms of a node. `pose` and `mount` throw std::exception with the reason if there is none.
struct Frames {
  std::function<bool(Stamp)> knows;                      ///< whether `pose` would return
  std::function<Pose(Stamp)> pose;                       ///< of the base frame in the map frame
  std::function<Mount(const std::string& frame)> mount;  ///< of a sensor's frame in the base frame
  std::function<void()> forget;                          ///< all but the static ones
};

/// The pose of a point that is `ahead` (m) of another one on the car.
inline Pose moved_ahead(const Pose& pose, double ahead) {
  return {pose.x + ahead * std::cos(pose.yaw), pose.y + ahead * std::sin(pose.yaw), pose.yaw};
}

/// Whether two poses of a sensor are the same, to within 5 mm and 5 mrad.
inline bool same_place(const Pose& a, const Pose& b) {
  return std::hypot(a.x - b.x, a.y - b.y) < 0.005 &&
         std::abs(std::remainder(a.yaw - b.yaw, 6.283185307179586)) < 0.005;
}

}  // namespace slalom_bridge
