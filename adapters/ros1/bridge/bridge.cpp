#include "bridge.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <memory>

#include "slalom/evaluation/arena.hpp"
#include "slalom/sim/placement.hpp"
#include "slalom/sim/wheel_odometry.hpp"
#include "slalom/sim/world.hpp"
#include "slalom/vehicle/configuration.hpp"
#include "slalom/vehicle/localiser.hpp"
#include "slalom/vehicle/planner.hpp"

namespace slalom_bridge {
namespace {

namespace fs = std::filesystem;
using slalom::maps::LaserScanView;

Pose plain(const slalom::maps::Pose& p) {
  return {p.x, p.y, p.yaw};
}
slalom::maps::Pose pose(const Pose& p) {
  return {p.x, p.y, p.yaw};
}
LaserScanView view(const Scan& s) {
  return {{s.ranges, s.count}, s.angle_min, s.angle_increment, s.range_min, s.range_max};
}
fs::path program_folder() {
  return fs::read_symlink("/proc/self/exe").parent_path();
}
std::shared_ptr<const slalom::evaluation::Arena> arena_of(const std::string& course) {
  const auto roots = slalom::vehicle::course_roots(program_folder());
  return slalom::evaluation::load_arena(slalom::vehicle::find_course(course, roots),
                                        slalom::evaluation::Evaluation::true_physics, roots);
}

}  // namespace

struct Planner::Hidden {
  std::unique_ptr<slalom::vehicle::Planner> planner;
};

Planner::Planner(const std::string& course, const std::string& configuration, const std::string& method)
    : hidden_(std::make_unique<Hidden>()) {
  const auto arena = arena_of(course);
  slalom::vehicle::Configuration settings;
  if (!configuration.empty()) {
    const auto roots = slalom::vehicle::configuration_roots(program_folder());
    settings =
        slalom::vehicle::load_configuration(slalom::vehicle::find_configuration(configuration, roots), roots);
  }
  hidden_->planner = std::make_unique<slalom::vehicle::Planner>(
      settings.planner, settings.vehicle, arena->path, arena->course.closed,
      slalom::vehicle::make_solver(settings, method, 1));
}
Planner::~Planner() = default;

Command Planner::update(const Scan& scan, const Pose& at, double speed) {
  using slalom::vehicle::PlannerStatus;
  const auto& out = hidden_->planner->update({view(scan), {pose(at), speed}});
  Command command{out.command.steer, out.command.speed, true, slalom::vehicle::name(out.status), 0,
                  out.tick_time};
  command.ok = out.status == PlannerStatus::ok || out.status == PlannerStatus::unverified ||
               out.status == PlannerStatus::solver_degenerate;
  if (out.solve) command.effective_samples = out.solve->effective_sample_size;
  if (!std::isfinite(command.steer) || !std::isfinite(command.speed))
    command = {0, 0, false, "not finite", 0, 0};
  return command;
}

struct Localiser::Hidden {
  slalom::vehicle::Localiser localiser;
};

Localiser::Localiser(const std::string& course, bool everywhere, std::uint64_t seed) {
  const auto arena = arena_of(course);
  slalom::vehicle::LocaliserOptions options;
  options.seed = seed;
  hidden_ = std::make_unique<Hidden>(Hidden{slalom::vehicle::Localiser(arena->course.map, options)});
  if (!everywhere) {
    const slalom::sim::CarParameters car;
    hidden_->localiser.start_at(
        slalom::sim::rear_axle(car, {.x = arena->start.x, .y = arena->start.y, .yaw = arena->start.yaw}));
  }
}
Localiser::~Localiser() = default;

void Localiser::start_at(const Pose& at) {
  hidden_->localiser.start_at(pose(at));
}

Estimate Localiser::update(const Scan& scan, const Pose& odometry, double stamp) {
  const auto& out = hidden_->localiser.update({view(scan), pose(odometry), stamp});
  Estimate e;
  e.pose = plain(out.pose);
  e.odometry_frame = plain(hidden_->localiser.odometry_frame());
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) e.covariance[i][j] = out.covariance[i][j];
  e.usable = out.status == slalom::vehicle::LocaliserStatus::ok;
  e.status = slalom::vehicle::name(out.status);
  e.health = out.health;
  return e;
}

struct World::Hidden {
  std::shared_ptr<const slalom::evaluation::Arena> arena;
  slalom::sim::WorldOptions options;
  slalom::sim::World world;
  slalom::sim::WheelOdometry odometry;
  std::uint64_t seed = 0;
  std::vector<slalom::maps::Pose> parked;
  std::vector<Pose> obstacles;
  Reading reading;
  bool touching = false;

  void read() {
    const auto seen = world.observe(0);
    const slalom::sim::CarParameters& car = options.car;
    reading.ranges.assign(seen.scan.ranges.begin(), seen.scan.ranges.end());
    reading.angle_min = seen.scan.angle_min;
    reading.angle_increment = seen.scan.angle_increment;
    reading.range_max = seen.scan.range_max;
    reading.odometry = plain(odometry.pose());
    reading.truth = plain(slalom::sim::rear_axle(car, world.state(0)));
    reading.speed = odometry.speed();
    reading.yaw_rate = odometry.yaw_rate();
    reading.laps = world.laps(0) ? world.laps(0)->laps() : 0;
    reading.contacts += seen.contact() && !touching;
    touching = seen.contact();
  }
};

World::World(const std::string& course, std::uint64_t seed, int obstacles) {
  const auto arena = arena_of(course);
  slalom::sim::WorldOptions options = arena->world_options();
  options.time_step = 0.005;
  options.lidar.beams = 1081;
  options.lidar.field_of_view = 4.71238898;
  options.lidar.rate = 40;
  slalom::sim::WheelOdometryOptions wheels;
  wheels.seed = seed;
  hidden_ = std::make_unique<Hidden>(Hidden{arena,
                                            options,
                                            slalom::sim::World(options, arena->track),
                                            slalom::sim::WheelOdometry(options.car, wheels),
                                            seed,
                                            {},
                                            {},
                                            {}});
  for (const auto& placed : slalom::sim::place_apart(arena->course.obstacle_path, arena->obstacle_room,
                                                     obstacles, seed, {arena->start.x, arena->start.y})) {
    hidden_->parked.push_back(placed.pose);
    hidden_->obstacles.push_back(plain(placed.pose));
  }
  reset();
}
World::~World() = default;

void World::reset() {
  hidden_->world.reset(hidden_->seed, std::array{hidden_->arena->start}, hidden_->parked);
  hidden_->odometry.reset(hidden_->world.state(0));
  hidden_->reading.contacts = 0;
  hidden_->read();
}

void World::step(double steer, double speed) {
  for (int i = 0; i < 5; ++i) {
    hidden_->world.step(std::array{slalom::sim::Command{steer, speed}});
    hidden_->odometry.update(hidden_->world.state(0), hidden_->options.time_step);
  }
  hidden_->read();
}

const World::Reading& World::reading() const {
  return hidden_->reading;
}
const std::vector<Pose>& World::obstacles() const {
  return hidden_->obstacles;
}

}  // namespace slalom_bridge
