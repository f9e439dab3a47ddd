#include "slalom/sim/world.hpp"

#include <array>

#include "bridge/convert.hpp"
#include "slalom/evaluation/environment.hpp"
#include "slalom/sim/placement.hpp"
#include "slalom/sim/wheel_odometry.hpp"

namespace slalom_bridge {
namespace {

std::shared_ptr<const slalom::evaluation::Environment> arena_of(const std::string& course) {
  const auto roots = slalom::vehicle::course_roots(program_folder());
  return slalom::evaluation::make_environment(
      slalom::vehicle::load_course(slalom::vehicle::find_course(course, roots)),
      slalom::evaluation::Protocol::true_physics);
}

}  // namespace

Course load_course(const std::string& name) {
  using slalom::maps::Occupancy;
  const auto loaded = slalom::vehicle::load_course(
      slalom::vehicle::find_course(name, slalom::vehicle::course_roots(program_folder())));
  Course course;
  course.name = loaded.name;
  course.closed = loaded.closed;
  course.map = {loaded.map.width, loaded.map.height, loaded.map.resolution, plain(loaded.map.origin), {}};
  for (const Occupancy cell : loaded.map.cells)
    course.map.cells.push_back(cell == Occupancy::unknown ? -1 : cell == Occupancy::occupied ? 100 : 0);
  for (const auto& w : loaded.waypoints) course.waypoints.push_back({w.x, w.y, w.yaw, w.speed});
  course.start =
      plain(slalom::sim::rear_axle({}, {.x = loaded.start.x, .y = loaded.start.y, .yaw = loaded.start.yaw}));
  return course;
}

struct World::Hidden {
  std::shared_ptr<const slalom::evaluation::Environment> environment;
  slalom::sim::WorldOptions options;
  slalom::sim::World world;
  slalom::sim::WheelOdometry odometry;
  std::uint64_t seed = 0;
  std::vector<slalom::maps::Pose> parked;
  std::vector<Pose> obstacles;
  Reading reading;
  bool colliding = false;

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
    reading.contacts += seen.collides() && !colliding;
    colliding = seen.collides();
  }
};

World::World(const std::string& course, std::uint64_t seed, int obstacles) {
  const auto environment = arena_of(course);
  slalom::sim::WorldOptions options = environment->world_options();
  options.lidar = slalom::sim::LidarOptions::hokuyo_utm_30lx();
  slalom::sim::WheelOdometryOptions wheels;
  wheels.seed = seed;
  hidden_ = std::make_unique<Hidden>(Hidden{environment,
                                            options,
                                            slalom::sim::World(options, environment->track),
                                            slalom::sim::WheelOdometry(options.car, wheels),
                                            seed,
                                            {},
                                            {},
                                            {}});
  for (const auto& placed :
       slalom::sim::place_apart(environment->course.obstacle_path, environment->obstacle_room, obstacles,
                                seed, {environment->start.x, environment->start.y})) {
    hidden_->parked.push_back(placed.pose);
    hidden_->obstacles.push_back(plain(placed.pose));
  }
  reset();
}
World::~World() = default;

void World::reset() {
  hidden_->world.reset(hidden_->seed, std::array{hidden_->environment->start}, hidden_->parked);
  hidden_->odometry.reset(hidden_->world.state(0));
  hidden_->reading.contacts = 0;
  hidden_->read();
}

void World::step(double steer, double speed) {
  for (int i = 0; i < 5; ++i) {
    hidden_->world.step(std::array{slalom::Command{steer, speed}});
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
Pose World::laser() const {
  const auto& mount = hidden_->options.lidar.mount;
  return {hidden_->options.car.rear_length + mount.x, mount.y, mount.yaw};
}
double World::car_length() const {
  return hidden_->options.car.length;
}
double World::car_width() const {
  return hidden_->options.car.width;
}

}  // namespace slalom_bridge
