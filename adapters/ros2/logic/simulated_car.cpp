#include "logic/simulated_car.hpp"

#include "slalom/sim/placement.hpp"

namespace slalom::nodes {
namespace {

sim::WorldOptions world_options(const evaluation::Environment& environment) {
  sim::WorldOptions options = environment.world_options();
  options.lidar = sim::LidarOptions::hokuyo_utm_30lx();
  return options;
}

}  // namespace

SimulatedCar::SimulatedCar(const vehicle::Course& course, std::uint64_t seed, int obstacles,
                           const std::optional<maps::Pose>& other)
    : environment_(evaluation::make_environment(course, evaluation::Protocol::true_physics)),
      seed_(seed),
      world_(world_options(*environment_), environment_->track),
      odometry_(parameters(), {.seed = seed}) {
  const maps::Pose& start = environment_->start;
  parked_ = sim::place_apart(environment_->course.obstacle_path, environment_->obstacle_room, obstacles, seed,
                             {start.x, start.y});
  starts_ = {start};
  if (other) starts_.push_back(*other);
  reset();
}

void SimulatedCar::reset() {
  world_.reset(seed_, starts_, parked_);
  odometry_.reset(world_.state(0));
  collisions_ = 0;
}

void SimulatedCar::step(const Command& command, const Command& other) {
  const double time_step = world_.options().time_step;
  const std::array commands{command, other};
  for (int steps = static_cast<int>(std::lround(period / time_step)); steps > 0; --steps) {
    world_.step(std::span(commands).first(starts_.size()));
    odometry_.update(world_.state(0), time_step);
  }
  const bool collides = world_.observe(0).collides();
  collisions_ += collides && !colliding_;
  colliding_ = collides;
}

maps::Pose SimulatedCar::pose() const {
  return sim::rear_axle(parameters(), world_.state(0));
}

maps::Pose SimulatedCar::laser() const {
  const maps::Pose& mount = world_.options().lidar.mount;
  return {parameters().rear_length + mount.x, mount.y, mount.yaw};
}

}  // namespace slalom::nodes
