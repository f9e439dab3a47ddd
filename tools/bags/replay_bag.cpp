#include "tools/bags/replay_bag.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "slalom/core/error.hpp"
#include "slalom/sim/collision_log.hpp"
#include "src/evaluation/json.hpp"
#include "tools/bags/bag_drive.hpp"
#include "tools/recording/recording.hpp"

namespace slalom::tools {
namespace {

using namespace evaluation;

/// The course of a bag's own map and waypoints.
vehicle::Course course_of(const BagReplay& replay, const BagDrive& drive) {
  if (!drive.map || drive.path.empty())
    throw IoError(replay.file, 0,
                  std::string("has no message on ") + (drive.map ? "/reference_waypoint" : "/map") +
                      ": name the course with --course");
  vehicle::Course course;
  course.name = std::filesystem::path(replay.file).stem().string();
  course.description = "from " + std::filesystem::path(replay.file).filename().string();
  course.map = *drive.map;
  course.waypoints = drive.path;
  vehicle::complete_course(course);
  return course;
}

/// The LiDAR that took the scans, and a car under it.
sim::LidarOptions lidar_of(const BagDrive& drive, const vehicle::PlannerOptions& planner,
                           double rear_length) {
  const BagTick& first = drive.ticks.front();
  sim::LidarOptions lidar;
  lidar.beams = std::max(1, static_cast<int>(first.ranges.size()));
  lidar.field_of_view = std::abs(first.shape.angle_increment) * (lidar.beams - 1);
  lidar.range_max = first.shape.range_max;
  lidar.mount = {planner.laser_x - rear_length, planner.laser_y, planner.laser_yaw};
  return lidar;
}

Scenario scenario_of(const BagReplay& replay, const BagDrive& drive) {
  Scenario scenario;
  scenario.configuration = load_configuration(replay.driver, replay.method);
  if (drive.laser) {
    vehicle::PlannerOptions& planner = scenario.configuration.planner;
    planner.laser_x = drive.laser->x;
    planner.laser_y = drive.laser->y;
    planner.laser_yaw = drive.laser->yaw;
  }
  std::shared_ptr<Environment> environment;
  if (replay.driver.course.empty()) {
    environment = make_environment(course_of(replay, drive), Protocol::true_physics);
  } else {
    const auto roots = vehicle::course_roots(program_folder());
    scenario.folder = vehicle::find_course(replay.driver.course, roots);
    environment = make_environment(vehicle::load_course(scenario.folder), Protocol::true_physics);
  }
  environment->lidar =
      lidar_of(drive, scenario.configuration.planner, environment->world_options().car.rear_length);
  scenario.environment = environment;
  return scenario;
}

/// Root mean square of the added values.
class Difference {
 public:
  void add(double value) {
    sum_ += value * value;
    ++count_;
  }
  double value() const { return count_ > 0 ? std::sqrt(sum_ / count_) : 0; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

/// The car of a bag, with a planner that processes its scans.
class Follower {
 public:
  Follower(const BagReplay& replay, const BagDrive& drive, const Scenario& scenario)
      : drive_(drive),
        environment_(*scenario.environment),
        published_maps_(scenario.configuration.planner.published.maps),
        planner_(scenario.configuration.planner, vehicle::make_vehicle_model(scenario.configuration.vehicle),
                 environment_.path,
                 vehicle::make_solver(scenario.configuration, replay.method, replay.driver.threads)),
        meter_(environment_.path, scenario.configuration.vehicle),
        world_(world_options(), environment_.track) {
    const maps::Pose start = pose(state(drive_.ticks.front()));
    world_.reset(0, {&start, 1});
    world_.set_scanning(0, false);
  }

  LapResult run(const ControlStepCallback& on_step) {
    LapResult lap;
    for (const BagTick& tick : drive_.ticks) {
      follow(tick, lap.steps, on_step);
      ++lap.steps;
    }
    lap.time = drive_.ticks.back().time;
    lap.collisions = log_.collisions();
    return lap;
  }

  double steer_difference() const { return steer_.value(); }  ///< rad
  double speed_difference() const { return speed_.value(); }  ///< m/s

 private:
  static maps::Pose pose(const sim::CarState& state) { return {state.x, state.y, state.yaw}; }

  sim::WorldOptions world_options() const {
    sim::WorldOptions options = environment_.world_options();
    const double ticks = static_cast<double>(drive_.ticks.size() - 1);
    // The world's clock ticks evenly; over the whole drive it agrees with the bag's.
    const double duration = drive_.ticks.back().time - drive_.ticks.front().time;
    options.time_step = std::clamp(ticks > 0 ? duration / ticks : 0.025, 1e-3, 0.1);
    options.start_anywhere = true;  // a pose that was guessed may lie in a wall
    return options;
  }

  /// The path of the centre of gravity, as far as it was measured.
  sim::CarState state(const BagTick& tick) const {
    const maps::Pose& rear = tick.odometry.pose;
    const maps::Point centre = maps::transform(rear, {environment_.world_options().car.rear_length, 0});
    return {.x = centre.x, .y = centre.y, .speed = tick.odometry.speed, .yaw = rear.yaw};
  }

  void follow(const BagTick& tick, int step, const ControlStepCallback& on_step) {
    maps::LaserScanView scan = tick.shape;
    scan.ranges = tick.ranges;
    const vehicle::PlannerOutput& output = planner_.update({scan, tick.odometry});
    meter_.observe(scan, tick.odometry.pose, published_maps_ ? &planner_.cost_map() : nullptr);
    sim::CarState car = state(tick);
    car.steer = output.steer_estimate;
    world_.follow({&car, 1});
    log_.update(world_, 0);
    sim::Observation seen = world_.observe(0);
    const maps::Pose& mount = world_.options().lidar.mount;
    const maps::Point sensor = maps::transform(seen.pose, {mount.x, mount.y});
    seen.sensor = {sensor.x, sensor.y, seen.pose.yaw + mount.yaw};
    seen.scan = scan;
    seen.time = seen.scan_time = tick.time;
    steer_.add(output.command.steer - tick.command.steer);
    speed_.add(output.command.speed - tick.command.speed);
    on_step({step, tick.time, world_.laps(0)->progress() / environment_.track->lap_path()->length(),
             log_.collisions(), seen, scan, tick.odometry, output, planner_, world_, meter_.planned(output)});
  }

  const BagDrive& drive_;
  const Environment& environment_;
  bool published_maps_;
  vehicle::Planner planner_;
  SequenceCostMeter meter_;
  sim::World world_;
  sim::CollisionLog log_;
  Difference steer_, speed_;
};

}  // namespace

void record_bag(const BagReplay& replay) {
  const BagDrive drive = load_bag_drive(replay.file);
  const Scenario scenario = scenario_of(replay, drive);
  ScenarioArguments told = replay.driver;
  told.course = scenario.environment->course.name;
  auto settings = settings_json(told, scenario, replay.method);
  settings["bag"] = replay.file;
  const auto recording =
      make_recording(replay.record, {.arguments = told,
                                     .scenario = scenario,
                                     .method = replay.method,
                                     .control_period = scenario.configuration.planner.control_period,
                                     .settings = settings});
  Follower follower(replay, drive, scenario);
  recording->begin_lap(1, 0);
  const LapResult lap = follower.run([&](const ControlStep& tick) { recording->add(tick); });
  recording->end_lap(lap, 1);
  recording->close();
  std::printf("%zu scans over %.1f s; %d more were omitted, since a pose, a speed or a command was missing\n",
              drive.ticks.size(), drive.ticks.back().time, drive.left_out);
  std::printf("the commands of %s differ from those in the bag by %.4f rad and %.3f m/s (root mean square)\n",
              replay.method.c_str(), follower.steer_difference(), follower.speed_difference());
}

}  // namespace slalom::tools
