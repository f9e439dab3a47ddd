// A racing car on a course: LiDAR scan and odometry in, steering and speed out.
// The argument is the folder of the course.

#include <slalom/evaluation/environment.hpp>
#include <slalom/solvers/registry.hpp>
#include <slalom/solvers/svg_mppi_options.hpp>
#include <slalom/vehicle/planner/planner.hpp>

#include "seeds.hpp"

using namespace slalom;

/// Whether the car drives a lap within 20 s without a collision.
bool drives_a_lap(const evaluation::Environment& environment, std::uint64_t seed) {
  SvgMppiOptions options;
  options.horizon = 14;
  options.samples = 2000;
  options.temperature = 3;
  options.input_min = -0.4189;
  options.input_max = 0.4189;
  options.seed = seed;
  vehicle::Planner planner({}, vehicle::make_vehicle_model({}), environment.path, make_solver(options, 1));
  sim::WorldOptions world_options = environment.world_options();
  sim::World world(world_options, environment.track);
  world.reset(seed, {&environment.start, 1});

  while (world.laps(0)->laps() < 1 && world.time() < 20) {
    const sim::Observation seen = world.observe(0);
    const maps::Point axle = maps::transform(seen.pose, {-world_options.car.rear_length, 0});
    const auto& output = planner.update({seen.scan, {{axle.x, axle.y, seen.pose.yaw}, seen.speed}});
    const Command command{output.command.steer, output.command.speed};
    for (int k = 0; k < 5; ++k) {  // 25 ms
      world.step({&command, 1});
      if (world.observe(0).collides()) return false;
    }
  }
  return world.laps(0)->laps() == 1;
}

int main(int, char** argv) {
  const auto environment = evaluation::load_environment(argv[1], evaluation::Protocol::true_physics, {});
  const int count = succeeded([&](auto seed) { return drives_a_lap(*environment, seed); });
  std::printf("a lap without collision: %d of 20 seeds\n", count);
  return count == 20 ? 0 : 1;
}
