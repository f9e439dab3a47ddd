#include "bench/workload/reference_workload.hpp"

#include "slalom/core/random.hpp"
#include "slalom/vehicle/published/options.hpp"

namespace slalom::workload {

namespace {

/// The centre line of the course in polar coordinates, compressed along y.
constexpr double squeeze = 0.8;
double radius(double turn) {
  return 8 + 2.5 * std::cos(3 * turn);
}
maps::Point middle(double turn) {
  return {radius(turn) * std::cos(turn), squeeze * radius(turn) * std::sin(turn)};
}

constexpr double half_width = 1.1, car_radius = 0.28;

bool blocked(double x, double y) {
  const double turn = std::atan2(y / squeeze, x);
  if (std::abs(std::hypot(x, y / squeeze) - radius(turn)) > half_width) return true;
  const maps::Point near = middle(0.27), far = middle(0.6);
  return std::hypot(x - near.x - 0.5, y - near.y) < car_radius ||
         std::hypot(x - far.x + 0.4, y - far.y) < car_radius;
}

constexpr int beams = 1080;
constexpr double first_beam = -2.35, field_of_view = 4.7;

}  // namespace

std::vector<maps::ReferencePoint> reference_course() {
  std::vector<maps::ReferencePoint> path;
  double travelled = 0;
  maps::Point last = middle(0);
  for (int i = 0; i < 100000; ++i) {
    const double turn = 2 * std::numbers::pi * i / 100000;
    const maps::Point here = middle(turn);
    travelled += std::hypot(here.x - last.x, here.y - last.y);
    last = here;
    if (i > 0 && travelled < 0.05) continue;
    travelled = 0;
    const maps::Point ahead = middle(turn + 1e-5);
    path.push_back({here.x, here.y, std::atan2(ahead.y - here.y, ahead.x - here.x), 4 + std::cos(3 * turn)});
  }
  return path;
}

maps::LaserScanView ReferenceScan::view() const {
  return {ranges, first_beam, field_of_view / (beams - 1), 0.02, 30};
}

ReferenceScan reference_scan(const maps::Pose& robot) {
  const maps::Pose laser = maps::LocalCostMapOptions{}.laser;
  const double x0 = robot.x + laser.x * std::cos(robot.yaw), y0 = robot.y + laser.x * std::sin(robot.yaw);
  ReferenceScan scan;
  for (int i = 0; i < beams; ++i) {
    const double angle = robot.yaw + first_beam + i * field_of_view / (beams - 1);
    double range = 0.05;
    while (range < 12 && !blocked(x0 + range * std::cos(angle), y0 + range * std::sin(angle))) range += 0.02;
    scan.ranges.push_back(static_cast<float>(range));
  }
  return scan;
}

vehicle::VehicleOptions reference_problem() {
  vehicle::VehicleOptions options = vehicle::published::vehicle_options();
  options.own_of<vehicle::published::ModelOptions>().straight_local_rollout = false;
  return options;
}

ReferenceWorkload::ReferenceWorkload()
    : field_(reference_course(), maps::published_reference_field()),
      cost_map_([] {
        auto options = maps::published_cost_map();
        options.outside = -1;
        return options;
      }()),
      clearance_map_({.reach = 1}) {
  const maps::ReferencePoint first = reference_course().front();
  robot_ = {first.x + 0.1, first.y, first.yaw + 0.05};
  start_ = {robot_.x, robot_.y, robot_.yaw, first.speed, 0.05};
  field_.update(robot_);
  cost_map_.update(reference_scan(robot_).view());
  clearance_map_.add(cost_map_.points());
}

std::unique_ptr<vehicle::VehicleModel> ReferenceWorkload::model(const vehicle::VehicleOptions& options,
                                                                simd::Target target) const {
  auto made = vehicle::make_vehicle_model(options, target);
  const bool discs = made->traits().obstacles.map == vehicle::ObstacleMap::clearance;
  made->set_maps({field_.view(), discs ? clearance_map_.view() : cost_map_.view(), robot_});
  made->set_start({{start_.x, start_.y, start_.yaw}, start_.speed, start_.steer}, options.reference_speed);
  return made;
}

SequenceBatch ReferenceWorkload::sequences(int samples, int steps_wanted, int inputs) const {
  SequenceBatch batch(steps_wanted, inputs, samples);
  RandomStream random({1, 2});
  for (int t = 0; t < steps_wanted; ++t) {
    for (int k = 0; k < batch.stride(); ++k) {
      batch.at(t, 0, k) = static_cast<float>(std::clamp(0.05 + 0.2 * random.normal(), -0.45, 0.45));
      for (int i = 1; i < inputs; ++i)
        batch.at(t, i, k) = static_cast<float>(std::clamp(2 * random.normal(), -9.0, 9.0));
    }
  }
  return batch;
}

}  // namespace slalom::workload
