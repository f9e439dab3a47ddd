#pragma once

#include "slalom/sim/pure_pursuit.hpp"
#include "slalom/sim/wheel_odometry.hpp"
#include "slalom/sim/world.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "slalom/vehicle/localisation/localiser.hpp"

namespace slalom::vehicle::test {

/// A course with what is made once for all drives on it.
struct PreparedCourse {
  Course course;
  std::shared_ptr<const sim::Track> track;
  std::vector<sim::PathPoint> path;

  explicit PreparedCourse(const std::string& name, double speed_factor = 0.8)
      : course(load_course(std::filesystem::path(SLALOM_COURSES) / name)),
        track(std::make_shared<const sim::Track>(course.map)) {
    for (const auto& w : course.waypoints) path.push_back({{w.x, w.y}, speed_factor * w.speed});
  }
  /// The pose on the path at a share of its length.
  maps::Pose at(double share) const {
    const auto& w =
        course.waypoints[static_cast<std::size_t>(share * static_cast<double>(course.waypoints.size()))];
    return {w.x, w.y, w.yaw};
  }
};

inline const PreparedCourse& wren() {
  static const PreparedCourse prepared("wren");
  return prepared;
}

/// A car that follows the path by its true pose, with a LiDAR of 1081 beams at 40 Hz and wheel odometry.
class Drive {
 public:
  static constexpr double time_step = 0.005, period = 0.025;  // s

  Drive(const PreparedCourse& prepared, const maps::Pose& start, std::uint64_t seed)
      : world_(world_options(), prepared.track),
        pursuit_(prepared.path, {.lookahead = 0.9}),
        odometry_(sim::CarParameters{}, {.seed = seed}) {
    world_.reset(seed, std::array{start});
    odometry_.reset(world_.state(0));
    read();
  }

  static sim::WorldOptions world_options() {
    sim::WorldOptions o{.time_step = time_step};
    o.lidar = {.beams = 1081, .field_of_view = 4.71238898, .noise = 0.02, .dropout = 0.01, .rate = 40};
    o.wall_response = sim::CollisionResponse::count_only;
    o.body_response = sim::CollisionResponse::count_only;
    return o;
  }

  /// One control period.
  void step() {
    const auto& s = world_.state(0);
    const Command command = pursuit_.command({s.x, s.y, s.yaw});
    for (int k = 0; k < static_cast<int>(std::lround(period / time_step)); ++k) {
      world_.step(std::array{command});
      odometry_.update(world_.state(0), time_step);
    }
    read();
  }

  /// Puts the car elsewhere, at the same speed; the odometry notices nothing.
  void kidnap(const maps::Pose& pose) {
    sim::CarState s = world_.state(0);
    s.x = pose.x;
    s.y = pose.y;
    s.yaw = pose.yaw;
    s.slip = s.yaw_rate = 0;
    world_.set_state(0, s);
    step();
  }

  maps::Pose truth() const { return sim::rear_axle(sim::CarParameters{}, world_.state(0)); }
  LocaliserInput input() const {
    const auto& lidar = world_.options().lidar;
    return {{ranges_, lidar.angle_min(), lidar.angle_increment(), 0.02, lidar.range_max},
            odometry_.pose(),
            world_.time()};
  }
  std::vector<float>& ranges() { return ranges_; }
  sim::World& world() { return world_; }

 private:
  void read() {
    const auto ranges = world_.observe(0).scan.ranges;
    ranges_.assign(ranges.begin(), ranges.end());
  }

  sim::World world_;
  sim::PurePursuit pursuit_;
  sim::WheelOdometry odometry_;
  std::vector<float> ranges_;
};

struct Error {
  double distance = 0;  ///< m
  double yaw = 0;       ///< rad
};
inline Error error_of(const maps::Pose& a, const maps::Pose& b) {
  return {std::hypot(a.x - b.x, a.y - b.y), std::abs(maps::wrap_angle(a.yaw - b.yaw))};
}

}  // namespace slalom::vehicle::test
