#include "slalom/sim/racing_benchmark.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include "sim/gym/gym_distance.hpp"
#include "slalom/sim/shapes.hpp"

namespace slalom::sim {
namespace {

constexpr std::uint64_t seed = 12345;
constexpr double steering_delay = 0.02;                // s
constexpr double lap_end = 0.995, past_start = 0.999;  // shares of a lap
constexpr double min_time = 5;                         // s, of a lap

PlantOptions plant_options() {
  PlantOptions options;
  options.dynamics.integrator = Integrator::euler;
  options.dynamics.substeps = 1;
  options.dynamics.gym = options.actuation.gym = options.gym = true;
  options.steering_dead_time = steering_delay;
  return options;
}

LidarOptions lidar_options() {
  LidarOptions options;
  options.mount = {};
  options.gym = true;
  return options;
}

maps::Point velocity(const CarState& s) {
  return {s.speed * std::cos(s.yaw + s.slip), s.speed * std::sin(s.yaw + s.slip)};
}

}  // namespace

RacingBenchmark::RacingBenchmark(std::shared_ptr<const Track> track, std::vector<maps::Point> centre_line)
    : track_(std::move(track)),
      line_(std::move(centre_line)),
      plant_(CarParameters{}, plant_options(), time_step),
      lidar_(lidar_options()),
      starts_(seed),
      noise_(seed),
      scan_(static_cast<std::size_t>(lidar_options().beams)) {
  if (!track_) throw std::invalid_argument("track: must not be null");
  look();
}

void RacingBenchmark::look() {
  const CarState& state = plant_.state();
  lidar_.gym_scan(*track_, {state.x, state.y, state.yaw}, scan_);
  for (double& range : scan_) range += lidar_.options().noise * noise_.normal();
}

void RacingBenchmark::reset() {
  ++lap_;
  CarState state;
  start_progress_ = 0;
  if (lap_ > 0) {
    start_progress_ = starts_.uniform(0, 1);
    const maps::Pose pose = line_.pose(start_progress_);
    state.x = pose.x;
    state.y = pose.y;
    state.yaw = pose.yaw;
  }
  plant_.reset(state);
  ticks_ = 0;
  accelerations_.clear();
  step(std::array{Command{}});
  progress_ = 0;
}

void RacingBenchmark::step(std::span<const Command> commands) {
  for (int k = 0; k < steps_per_command; ++k) {
    const maps::Point before = velocity(plant_.state());
    plant_.step(commands[0]);
    const maps::Point after = velocity(plant_.state());
    accelerations_.push_back(std::hypot(after.x - before.x, after.y - before.y) / time_step);
  }
  ++ticks_;
  const CarState& state = plant_.state();
  collided_ = corner_in_wall();
  const double along = line_.progress({state.x, state.y});
  progress_ = along - start_progress_ + (along > start_progress_ ? 0 : 1);
  if (progress_ > past_start) progress_ = 0;
  complete_ = (progress_ > lap_end && time() > min_time) || time() > max_time;
  look();
}

bool RacingBenchmark::corner_in_wall() const noexcept {
  const CarState& state = plant_.state();
  const maps::OccupancyGrid& grid = track_->grid();
  for (const maps::Point& corner :
       corners(Box{{state.x, state.y, state.yaw}, plant_.car().length, plant_.car().width})) {
    const maps::Point at = maps::inverse_transform(grid.origin, corner);
    if (!(at.x >= 0 && at.y >= 0 && at.x < grid.width * grid.resolution &&
          at.y < grid.height * grid.resolution))
      return true;
    if (detail::gym_distance(*track_, corner) < collision_limit) return true;
  }
  return false;
}

double RacingBenchmark::time() const noexcept {
  return ticks_ * steps_per_command * time_step;
}

RacingObservation RacingBenchmark::observation() const noexcept {
  return {time(), plant_.state(), scan_, progress_};
}

}  // namespace slalom::sim
