#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "slalom/maps/pose.hpp"

/// Times and coordinate frames, as the cores of the nodes see them.
namespace slalom::nodes {

/// A time of the clock of the stamps, ns; 0: none. A transform can be looked up at exactly this time.
using Stamp = std::int64_t;

/// The time of a stamp, s.
inline double in_seconds(Stamp stamp) {
  return 1e-9 * static_cast<double>(stamp);
}
/// The nearest stamp to a time (s).
inline Stamp stamp_of(double seconds) {
  return static_cast<Stamp>(std::llround(1e9 * seconds));
}

/// The pose of a sensor's frame in the base frame.
struct Mount {
  double rotation[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  ///< from the sensor's axes to those of the base
  double x = 0, y = 0, z = 0;                                 ///< m

  /// The pose in the plane.
  maps::Pose planar() const { return {x, y, std::atan2(rotation[1][0], rotation[0][0])}; }
  /// Whether its z axis points upwards, to within 25 degrees.
  bool upright() const { return rotation[2][2] > 0.9; }
};

/// The mount with a translation (m) and a rotation, given as a unit quaternion.
inline Mount mount_of(double x, double y, double z, double qx, double qy, double qz, double qw) {
  return {{{1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qw * qz), 2 * (qx * qz + qw * qy)},
           {2 * (qx * qy + qw * qz), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qw * qx)},
           {2 * (qx * qz - qw * qy), 2 * (qy * qz + qw * qx), 1 - 2 * (qx * qx + qy * qy)}},
          x,
          y,
          z};
}

/// The component along an axis of the base (0: x, ahead; 1: y, left; 2: z) of a vector in the sensor's axes.
inline double along(int axis, const Mount& mount, const double (&vector)[3]) {
  const double(&row)[3] = mount.rotation[axis];
  return row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2];
}

/// The transforms of a node. `pose` and `mount` throw std::exception with the reason if there is none.
struct Transforms {
  std::function<bool(Stamp)> knows;                      ///< whether `pose` would return
  std::function<maps::Pose(Stamp)> pose;                 ///< pose of the base frame in the map frame
  std::function<Mount(const std::string& frame)> mount;  ///< pose of a sensor's frame in the base frame
  std::function<void()> forget;                          ///< discards all but the static ones
};

/// The pose of a point that is `ahead` (m) of another one on the car.
inline maps::Pose moved_ahead(const maps::Pose& pose, double ahead) {
  return {pose.x + ahead * std::cos(pose.yaw), pose.y + ahead * std::sin(pose.yaw), pose.yaw};
}

/// A pose given in the frame of `frame`, in the frame in which `frame` is given.
inline maps::Pose composed(const maps::Pose& frame, const maps::Pose& pose) {
  const maps::Point at = maps::transform(frame, {pose.x, pose.y});
  return {at.x, at.y, frame.yaw + pose.yaw};
}

/// Whether two poses of a sensor are the same, to within 5 mm and 5 mrad.
inline bool same_place(const maps::Pose& a, const maps::Pose& b) {
  return std::hypot(a.x - b.x, a.y - b.y) < 0.005 && std::abs(maps::wrap_angle(a.yaw - b.yaw)) < 0.005;
}

}  // namespace slalom::nodes
