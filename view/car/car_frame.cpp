#include "view/car/car_frame.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "slalom/core/gravity.hpp"
#include "slalom/sim/shapes.hpp"
#include "view/protocol/frame_writer.hpp"

namespace slalom::view {
namespace {

using evaluation::ControlStep;
using vehicle::PredictedState;

constexpr const char* figure_labels =
    "speed steer yaw_rate slip command_steer command_speed steer_estimate draw_ms evaluate_ms guide_ms "
    "update_ms solve_ms lap lap_time progress path_distance clearance sequence_cost slip_estimate grip_used "
    "friction_estimate friction_relied_on steering_gain_estimate steering_offset_estimate delay_estimate "
    "odometry_x odometry_y odometry_yaw odometry_speed";

constexpr std::size_t state_size = 5;  // x, y, yaw, speed, steering
constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Returns the distance from the driven car to the nearest wall or other body, m; negative if they overlap.
double clearance_of(const sim::World& world) {
  const sim::Box body = world.outline(0);
  double least = std::numeric_limits<double>::infinity();
  for (const maps::Point& corner : sim::corners(body))
    least = std::min(least, world.track().distance_to_wall(corner));
  for (std::size_t i = 1; i < world.bodies(); ++i) {
    const auto disc = world.disc(i);
    least = std::min(least, disc ? sim::signed_gap(body, *disc) : sim::signed_gap(body, world.outline(i)));
  }
  return least;
}

void put_scan(FrameWriter& to, const ControlStep& step) {
  to.begin(Block::scan);
  to.put_pose(step.seen.sensor);
  to.put(static_cast<std::uint32_t>(step.scan.ranges.size()));
  for (const float range : step.scan.ranges) {
    const double millimetres = std::clamp(1000.0 * static_cast<double>(range), 0.0, 65535.0);
    to.put(static_cast<std::uint16_t>(millimetres));
  }
  to.end();
}

void put_cost_map(FrameWriter& to, const ControlStep& step) {
  const maps::LocalCostMap& map = step.planner.cost_map();
  const maps::GridGeometry& geometry = map.geometry();
  to.begin(Block::cost_map);
  to.put_pose(step.odometry.pose);
  to.put(static_cast<std::uint16_t>(geometry.rows));
  to.put(static_cast<std::uint16_t>(geometry.columns));
  to.put_f32({geometry.resolution, geometry.center_x, geometry.center_y});
  unsigned bits = 0;
  int filled = 0;
  for (int row = 0; row < geometry.rows; ++row) {
    for (int column = 0; column < geometry.columns; ++column) {
      bits |= static_cast<unsigned>(*map.cells().at(row, column) > 0) << filled;
      if (++filled < 8) continue;
      to.put(static_cast<std::uint8_t>(bits));
      bits = 0;
      filled = 0;
    }
  }
  if (filled > 0) to.put(static_cast<std::uint8_t>(bits));
  to.end();
}

/// Writes the cars that are tracked: the box of now, and the places of all hypotheses.
void put_others(FrameWriter& to, const ControlStep& step) {
  if (step.others.empty()) return;
  to.begin(Block::others);
  to.put(static_cast<std::uint32_t>(step.others.size()));
  for (const maps::PredictedObstacle& other : step.others) {
    to.put_f32({other.length, other.width, other.poses.front().pose.yaw});
    to.put(static_cast<std::uint16_t>(other.hypotheses));
    to.put(static_cast<std::uint16_t>(other.times()));
    for (int k = 0; k < other.hypotheses; ++k) to.put_f32(other.weights[static_cast<std::size_t>(k)]);
    to.begin_points({step.seen.pose.x, step.seen.pose.y});
    for (const maps::PredictedPose& place : other.poses) to.put_point({place.pose.x, place.pose.y});
  }
  to.end();
}

}  // namespace

void CarSource::observe(const ControlStep& step, double prediction_step) {
  step_ = &step;
  prediction_step_ = prediction_step;
  inputs_.assign(step.output.inputs.begin(), step.output.inputs.end());
}

int CarSource::status(const SolveResult&) const {
  return static_cast<int>(step_->output.status);
}

std::size_t CarSource::inputs_per_step() const {
  return static_cast<std::size_t>(step_->planner.solver().inputs());
}

Trajectories CarSource::roll_out(std::span<const double>, std::span<const float> sequences) {
  Trajectories all;
  const auto length = static_cast<std::size_t>(step_->planner.solver().horizon()) * inputs_per_step();
  std::vector<PredictedState> states(length / inputs_per_step() + 1);
  for (std::size_t at = 0; at + length <= sequences.size(); at += length) {
    step_->planner.predict(sequences.subspan(at, length), states);
    vehicle::PredictedCost before;
    all.collisions.push_back(-1);
    for (std::size_t k = 0; k < states.size(); ++k) {
      const PredictedState& state = states[k];
      const vehicle::PredictedCost& sum = state.cost;
      const double distance = sum.distance - before.distance;
      all.states.insert(all.states.end(),
                        {state.pose.x, state.pose.y, state.pose.yaw, state.speed, state.steer});
      all.costs.insert(all.costs.end(),
                       {distance, sum.state - before.state - distance, sum.collision - before.collision});
      if (sum.collided && all.collisions.back() < 0) all.collisions.back() = static_cast<int>(k);
      before = sum;
    }
  }
  return all;
}

std::vector<maps::Pose> CarSource::poses(std::span<const double> states) {
  std::vector<maps::Pose> all;
  for (std::size_t at = 0; at < states.size(); at += state_size)
    all.push_back({states[at], states[at + 1], states[at + 2]});
  return all;
}

std::vector<double> CarSource::figures() {
  const sim::World& world = step_->world;
  const sim::CarState& car = world.state(0);
  const vehicle::PlannerOutput& out = step_->output;
  const StageTimes times = out.solve ? out.solve->times : StageTimes{};
  const sim::LapTimer& laps = *world.laps(0);
  const int lap = laps.laps();
  std::vector<double> all{car.speed,         car.steer,         car.yaw_rate,      car.slip,
                          out.command.steer, out.command.speed, out.steer_estimate};
  for (const double time : {times.draw, times.evaluate, times.guide, times.update, times.total})
    all.push_back(1e3 * time);
  all.insert(all.end(), {static_cast<double>(lap), step_->time - laps.lap_start_time(),
                         laps.progress() / world.track().lap_path()->length() - lap, laps.offset(),
                         clearance_of(world), step_->cost.total()});
  const vehicle::ParameterEstimate& estimate = out.parameters;
  if (estimate.friction > 0) {
    const double turning = std::abs(out.speed_estimate * out.yaw_rate_estimate);
    all.insert(all.end(), {out.slip_estimate, turning / (estimate.friction * gravity), estimate.friction,
                           estimate.cautious_friction, estimate.steering_gain, estimate.steering_offset,
                           estimate.delay});
  } else {
    all.insert(all.end(), 7, none);  // the tyres do not slip
  }
  const maps::Pose& rear = step_->odometry.pose;
  all.insert(all.end(), {rear.x, rear.y, rear.yaw, step_->odometry.speed});
  return all;
}

std::string CarSource::blocks() {
  FrameWriter to;
  put_scan(to, *step_);
  put_cost_map(to, *step_);
  put_others(to, *step_);
  return to.take_blocks();
}

std::optional<StepMeasures> CarSource::measures() const {
  return StepMeasures{step_->time, step_->output.tick_time, step_->seen.collides(), step_->collisions,
                      prediction_step_};
}

SolveResult CarSource::solve() const {
  SolveResult solve = step_->output.solve ? *step_->output.solve : SolveResult{};
  if (!step_->output.inputs.empty()) solve.inputs = step_->output.inputs;
  return solve;
}

std::vector<Shape> CarSource::shapes() {
  return shapes_of(step_->world);
}

std::vector<Shape> shapes_of(const sim::World& world) {
  std::vector<Shape> all;
  const sim::CarParameters& car = world.options().car;
  const auto hit = world.observe(0).colliding;
  for (std::size_t i = 1; i < world.bodies(); ++i) {
    const sim::Box body = world.outline(i);
    Shape shape = box(body.pose, body.length, body.width);
    shape.is_disc = world.disc(i).has_value();
    const bool is_car = body.length == car.length && body.width == car.width;
    if (i < world.cars())
      shape.kind = ShapeKind::opponent;
    else if (is_car && !shape.is_disc)
      shape.kind = ShapeKind::parked_car;
    shape.touched = std::find(hit.begin(), hit.end(), static_cast<int>(i)) != hit.end();
    all.push_back(std::move(shape));
  }
  return all;
}

std::vector<double> state_of(const sim::World& world) {
  const sim::CarState& car = world.state(0);
  return {car.x, car.y, car.yaw, car.speed, car.steer};
}

std::shared_ptr<const SubjectFacts> car_facts(const evaluation::Environment* environment) {
  SubjectFacts facts;
  facts.inputs = {"steering, rad", "acceleration, m/s^2"};
  facts.terms = {"distance", "yaw", "collision"};
  facts.can_place = facts.can_move = facts.can_add = facts.can_delay = true;
  facts.fixes_seed = facts.scans_ahead = true;
  for (int i = 0; i <= static_cast<int>(vehicle::PlannerStatus::solver_degenerate); ++i)
    facts.statuses.emplace_back(name(static_cast<vehicle::PlannerStatus>(i)));
  facts.figures = words_of(figure_labels);
  facts.speed = 3;
  facts.steering = 4;
  if (!environment) return std::make_shared<const SubjectFacts>(std::move(facts));
  const sim::WorldOptions world = environment->world_options();
  facts.title = environment->course.name;
  facts.length = world.car.length;
  facts.width = world.car.width;
  facts.front = world.car.front_length;
  facts.rear = world.car.rear_length;
  facts.scanner = {world.lidar.angle_min(), world.lidar.angle_increment(), world.lidar.range_max};
  facts.map = environment->course.map;
  facts.course = environment->path;
  facts.is_closed = environment->course.closed;
  return std::make_shared<const SubjectFacts>(std::move(facts));
}

const std::vector<std::string>& car_scalars() {
  static const std::vector<std::string> names = scalar_names(*car_facts());
  return names;
}

ScenarioNames with_course(ScenarioNames names, const evaluation::Environment& environment) {
  names.description = environment.course.description;
  names.evaluation = evaluation::name(environment.protocol);
  names.length = environment.course.length;
  return names;
}

std::vector<OptionSection> sections_of(const vehicle::Configuration& configuration,
                                       const std::string& method) {
  std::vector<OptionSection> sections;
  for (auto& [name, options] : vehicle::list_sections(configuration)) {
    const auto place = name == method ? sections.begin() : sections.end();
    sections.insert(place, {name, std::move(options)});
  }
  return sections;
}

std::string encode_car(std::shared_ptr<const SubjectFacts> facts, const ControlStep& step, double period,
                       double prediction_step, int method) {
  CarSource source(std::move(facts));
  source.observe(step, prediction_step);
  return encode_frame(source, source.solve(),
                      {.tick = step.step,
                       .measures = *source.measures(),
                       .period = period,
                       .method = method,
                       .state = state_of(step.world)})
      .message;
}

}  // namespace slalom::view
