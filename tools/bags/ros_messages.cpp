#include "tools/bags/ros_messages.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>

namespace slalom::tools::ros {
namespace {

class Fields {
 public:
  explicit Fields(std::string_view bytes) : bytes_(bytes) {}

  template <class T>
  T get() {
    T value{};
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  double f32() { return static_cast<double>(get<float>()); }
  double f64() { return get<double>(); }
  std::string text() { return std::string(take(get<std::uint32_t>())); }
  /// The number of a list's elements, each of at least `size` bytes.
  std::size_t count(std::size_t size) {
    const auto number = get<std::uint32_t>();
    if (number > bytes_.size() / size) throw std::invalid_argument("is incomplete");
    return number;
  }
  std::string_view take(std::size_t size) {
    if (size > bytes_.size()) throw std::invalid_argument("is incomplete");
    const std::string_view taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }
  Header header() {
    get<std::uint32_t>();  // its number
    const auto seconds = get<std::uint32_t>(), nanoseconds = get<std::uint32_t>();
    return {seconds + 1e-9 * nanoseconds, text()};
  }
  /// A geometry_msgs/Pose or Transform on the plane.
  maps::Pose pose() {
    const double x = f64(), y = f64();
    f64();
    const double qx = f64(), qy = f64(), qz = f64(), qw = f64();
    return {x, y, std::atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz))};
  }
  /// The speed forwards of a geometry_msgs/Twist.
  double twist() {
    const double x = f64();
    take(5 * sizeof(double));
    return x;
  }
  void end() const {
    if (!bytes_.empty()) throw std::invalid_argument("is longer than its type");
  }

 private:
  std::string_view bytes_;
};

// Bytes on the wire, of a header with an empty frame.
constexpr std::size_t min_header = 16, pose_size = 7 * sizeof(double), twist_size = 6 * sizeof(double);
constexpr std::size_t covariance = 36 * sizeof(double);

}  // namespace

Scan scan(std::string_view bytes) {
  Fields f(bytes);
  Scan s;
  s.header = f.header();
  s.shape.angle_min = f.f32();
  f.f32();  // the last angle
  s.shape.angle_increment = f.f32();
  f.take(2 * sizeof(float));  // times between beams and scans
  s.shape.range_min = f.f32();
  s.shape.range_max = f.f32();
  s.ranges.resize(f.count(sizeof(float)));
  for (float& range : s.ranges) range = f.get<float>();
  f.take(f.count(sizeof(float)) * sizeof(float));  // intensities
  f.end();
  return s;
}

Odometry odometry(std::string_view bytes) {
  Fields f(bytes);
  Odometry o;
  o.header = f.header();
  f.text();  // the frame of the car
  o.pose = f.pose();
  f.take(covariance);
  o.speed = f.twist();
  f.take(covariance);
  f.end();
  return o;
}

Drive drive(std::string_view bytes) {
  Fields f(bytes);
  Drive d;
  d.header = f.header();
  d.steer = f.f32();
  f.f32();  // its rate
  d.speed = f.f32();
  f.take(2 * sizeof(float));  // acceleration, jerk
  f.end();
  return d;
}

maps::OccupancyGrid map(std::string_view bytes) {
  Fields f(bytes);
  f.header();
  f.take(2 * sizeof(std::uint32_t));  // when the map was loaded
  maps::OccupancyGrid grid;
  grid.resolution = f.f32();
  grid.width = f.get<std::int32_t>();
  grid.height = f.get<std::int32_t>();
  grid.origin = f.pose();
  if (!(grid.resolution > 0 && std::isfinite(grid.resolution)))
    throw std::invalid_argument("has a resolution that is not a finite number above 0");
  const std::size_t cells = f.count(1);
  if (grid.width <= 0 || grid.height <= 0 ||
      static_cast<double>(grid.width) * grid.height != static_cast<double>(cells))
    throw std::invalid_argument("has " + std::to_string(cells) + " cells, not width x height");
  for (const char cell : f.take(cells)) {
    const auto known = static_cast<std::int8_t>(cell);
    grid.cells.push_back(known < 0     ? maps::Occupancy::unknown
                         : known >= 50 ? maps::Occupancy::occupied
                                       : maps::Occupancy::free);
  }
  f.end();
  return grid;
}

std::vector<Waypoint> waypoints(std::string_view bytes) {
  Fields f(bytes);
  f.header();
  std::vector<Waypoint> points(f.count(min_header + pose_size));
  for (Waypoint& point : points) {
    f.header();
    point.pose = f.pose();
  }
  if (f.count(min_header + twist_size) != points.size())
    throw std::invalid_argument("has different numbers of poses and speeds");
  for (Waypoint& point : points) {
    f.header();
    point.speed = f.twist();
  }
  f.end();
  return points;
}

std::vector<Transform> transforms(std::string_view bytes) {
  Fields f(bytes);
  std::vector<Transform> all(f.count(min_header + sizeof(std::uint32_t) + pose_size));
  for (Transform& each : all) {
    each.parent = f.header().frame;
    each.child = f.text();
    each.pose = f.pose();
  }
  f.end();
  return all;
}

}  // namespace slalom::tools::ros
