#include "slalom/sim/racing_benchmark.hpp"

#include <algorithm>

#include "slalom/sim/shapes.hpp"
#include "slalom/sim/world.hpp"

namespace slalom::sim {
namespace {

constexpr std::uint64_t seed = 12345;
constexpr double lap_end = 0.995, past_start = 0.999;  // shares of a lap
constexpr double min_time = 5;                         // s, of a lap

PlantOptions plant_options() {
  PlantOptions options = WorldOptions::gym_compatible().plant;
  options.dynamics.integrator = Integrator::euler;
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
      lidar_(WorldOptions::gym_compatible().lidar),
      starts_(seed),
      noise_(seed),
      scan_(lidar_.angles().size()) {
  if (!track_) throw std::invalid_argument("track: must not be null");
  look();
}

void RacingBenchmark::look() {
  lidar_.gym_scan(*track_, plant_.state().pose(), scan_);
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
  const auto all = corners(Box{plant_.state().pose(), plant_.car().length, plant_.car().width});
  return std::any_of(all.begin(), all.end(), [&](const maps::Point& corner) {
    return !track_->contains(track_->to_cells(corner)) || track_->gym_distance(corner) < collision_limit;
  });
}

double RacingBenchmark::time() const noexcept {
  return ticks_ * steps_per_command * time_step;
}

RacingObservation RacingBenchmark::observation() const noexcept {
  return {time(), plant_.state(), scan_, progress_};
}

}  // namespace slalom::sim
