#include "tools/evaluation/racing_benchmark.hpp"

#include <cmath>
#include <utility>

#include "slalom/core/error.hpp"
#include "slalom/maps/ros_map.hpp"
#include "slalom/sim/follow_the_gap.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;

class GapDriver : public RacingDriver {
 public:
  Command command(const sim::RacingObservation& seen) override { return driver_.command(seen.scan); }

 private:
  sim::FollowTheGap driver_;
};

class PlannerDriver : public RacingDriver {
 public:
  PlannerDriver(vehicle::Planner planner, const sim::CarParameters& car, const sim::LidarOptions& lidar)
      : planner_(std::move(planner)), car_(car), lidar_(lidar) {}

  Command command(const sim::RacingObservation& seen) override {
    if (seen.time <= time_) planner_.reset(++laps_);
    time_ = seen.time;
    ranges_.assign(seen.scan.begin(), seen.scan.end());
    const sim::CarState& state = seen.state;
    const maps::Pose body{state.x, state.y, maps::wrap_angle(state.yaw)};
    const maps::Point axle = maps::transform(body, {-car_.rear_length, 0});
    const maps::LaserScanView scan{ranges_, lidar_.angle_min(), lidar_.angle_increment(), 0,
                                   lidar_.range_max};
    return planner_.update({.scan = scan, .odometry = {{axle.x, axle.y, body.yaw}, state.speed}}).command;
  }

 private:
  vehicle::Planner planner_;
  sim::CarParameters car_;
  sim::LidarOptions lidar_;
  std::vector<float> ranges_;
  double time_ = 0;
  std::uint64_t laps_ = 0;
};

}  // namespace

RacingMap load_racing_map(const fs::path& folder, const std::string& name) {
  const fs::path own = folder / name, from = fs::is_directory(own) ? own : folder;
  RacingMap map;
  map.name = name;
  map.grid = maps::load_ros_map(from / (name + ".yaml"), {.rule = maps::MapRule::grey_threshold});
  const fs::path file = from / (name + "_centerline.csv");
  map.centre_line = vehicle::read_centre_line(file).line.points;
  map.centre_line.erase(map.centre_line.begin());
  return map;
}

std::unique_ptr<RacingDriver> make_gap_driver() {
  return std::make_unique<GapDriver>();
}

std::unique_ptr<RacingDriver> make_planner_driver(const RacingMap& map,
                                                  const vehicle::Configuration& configuration,
                                                  const std::string& method) {
  vehicle::RacingCar car;
  vehicle::set_friction(car, racing_grip / 9.81);
  const vehicle::RaceCourse course = vehicle::race_course(map.grid, car);
  std::vector<maps::ReferencePoint> path;
  for (const vehicle::RacelinePoint& point : course.raceline.points)
    path.push_back({point.x, point.y, point.yaw, point.speed});
  const sim::CarParameters simulated;
  const sim::LidarOptions lidar;
  vehicle::PlannerOptions options = configuration.planner;
  options.control_period = sim::RacingBenchmark::time_step * sim::RacingBenchmark::steps_per_command;
  options.max_speed = std::min(options.max_speed, car.limits.top_speed);
  options.laser_x = simulated.rear_length;
  vehicle::Planner planner(options, vehicle::make_vehicle_model(configuration.vehicle), path,
                           vehicle::make_solver(configuration, method, 1));
  return std::make_unique<PlannerDriver>(std::move(planner), simulated, lidar);
}

std::vector<RacingLap> drive_racing_laps(const RacingMap& map, RacingDriver& driver, int laps) {
  sim::RacingBenchmark world(std::make_shared<const sim::Track>(map.grid), map.centre_line);
  std::vector<RacingLap> driven;
  for (int k = 0; k < laps; ++k) {
    world.reset();
    while (!world.collided() && !world.complete()) world.step(driver.command(world.observation()));
    RacingLap lap{world.time(), !world.collided(), world.observation().progress, 0, 0};
    for (const double acceleration : world.accelerations()) {
      ++lap.steps;
      lap.beyond += acceleration > racing_grip;
    }
    driven.push_back(lap);
  }
  return driven;
}

Json racing_results(const std::vector<RacingLap>& laps) {
  double sum = 0;
  int completed = 0, at_limit = 0;
  long long steps = 0, beyond = 0;
  Json times = Json::array();
  for (const RacingLap& lap : laps) {
    steps += lap.steps;
    beyond += lap.beyond;
    times.push_back(lap.completed ? Json(lap.time) : Json(nullptr));
    if (!lap.completed) continue;
    sum += lap.time;
    ++completed;
    at_limit += lap.time > sim::RacingBenchmark::max_time;
  }
  return {{"mean_s", completed > 0 ? Json(sum / completed) : Json(nullptr)},
          {"completed", completed},
          {"at_time_limit", at_limit},
          {"laps", static_cast<int>(laps.size())},
          {"beyond_grip", steps > 0 ? static_cast<double>(beyond) / static_cast<double>(steps) : 0.0},
          {"lap_times_s", times}};
}

}  // namespace slalom::tools
