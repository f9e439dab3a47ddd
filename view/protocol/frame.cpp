#include "view/protocol/frame.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "slalom/core/gravity.hpp"
#include "view/protocol/frame_writer.hpp"
#include "view/protocol/solve_blocks.hpp"

namespace slalom::view {
namespace {

using evaluation::ControlStep;
using vehicle::PredictedState;

constexpr const char* scalar_labels =
    "tick time x y yaw speed steer yaw_rate slip command_steer command_speed steer_estimate status "
    "distance_cost yaw_cost collision_cost minimum_cost expected_cost effective_samples samples "
    "collided_share temperature iterations tick_ms draw_ms evaluate_ms guide_ms update_ms solve_ms "
    "deadline_ms lap lap_time progress path_distance clearance contact contacts sequence_cost "
    "prediction_step method plan_cost slip_estimate grip_used friction_estimate friction_relied_on "
    "steering_gain_estimate steering_offset_estimate delay_estimate odometry_x odometry_y odometry_yaw "
    "odometry_speed symptom";

constexpr int sent_candidates = 160;  // samples that are sent

/// Returns the number of states that a sequence of inputs leads through.
std::size_t states_of(const vehicle::Planner& planner, std::span<const float> inputs) {
  return inputs.size() / static_cast<std::size_t>(planner.solver().inputs()) + 1;
}

void put_scan(FrameWriter& to, const ControlStep& tick) {
  to.begin(Block::scan);
  to.put_pose(tick.seen.sensor);
  to.put(static_cast<std::uint32_t>(tick.scan.ranges.size()));
  for (const float range : tick.scan.ranges) {
    const double millimetres = std::clamp(1000.0 * static_cast<double>(range), 0.0, 65535.0);
    to.put(static_cast<std::uint16_t>(millimetres));
  }
  to.end();
}

void put_cost_map(FrameWriter& to, const ControlStep& tick) {
  const maps::LocalCostMap& map = tick.planner.cost_map();
  const maps::GridGeometry& geometry = map.geometry();
  to.begin(Block::cost_map);
  to.put_pose(tick.odometry.pose);
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
void put_others(FrameWriter& to, const ControlStep& tick) {
  if (tick.others.empty()) return;
  to.begin(Block::others);
  to.put(static_cast<std::uint32_t>(tick.others.size()));
  for (const maps::PredictedObstacle& other : tick.others) {
    to.put_f32({other.length, other.width, other.poses.front().pose.yaw});
    to.put(static_cast<std::uint16_t>(other.hypotheses));
    to.put(static_cast<std::uint16_t>(other.times()));
    for (int k = 0; k < other.hypotheses; ++k) to.put_f32(other.weights[static_cast<std::size_t>(k)]);
    to.begin_points({tick.seen.pose.x, tick.seen.pose.y});
    for (const maps::PredictedPose& place : other.poses) to.put_point({place.pose.x, place.pose.y});
  }
  to.end();
}

}  // namespace

const std::vector<std::string>& scalar_names() {
  static const std::vector<std::string> names = words_of(scalar_labels);
  return names;
}

std::string FrameEncoder::encode(const ControlStep& tick, const StepFacts& facts) {
  const sim::World& world = tick.world;
  const sim::CarState& car = world.state(0);
  const vehicle::PlannerOutput& out = tick.output;
  const SolveResult* solve = out.solve;
  const vehicle::ParameterEstimate& estimate = out.parameters;
  const sim::LapTimer& laps = *world.laps(0);
  const StageTimes times = solve ? solve->times : StageTimes{};
  cost_ = {};
  step_costs_.clear();
  if (solve && !out.inputs.empty()) add_step_costs(predict(tick.planner, out.inputs));
  FrameWriter to;
  to.begin(Block::scalars);
  const double none = std::numeric_limits<double>::quiet_NaN(), step = tick.step;
  to.put({step, tick.time, car.x, car.y, car.yaw, car.speed, car.steer, car.yaw_rate, car.slip});
  to.put({out.command.steer, out.command.speed, out.steer_estimate, static_cast<double>(out.status)});
  to.put({cost_.distance, cost_.state - cost_.distance, cost_.collision});
  if (solve) {
    const double samples = solve->samples ? solve->samples->samples() : 0;
    to.put({solve->minimum_cost, solve->expected_cost, solve->effective_sample_size, samples});
    to.put({solve->collided_share, solve->temperature, static_cast<double>(solve->iterations)});
  } else {
    to.put({none, none, none, 0, none, none, 0});
  }
  to.put({1e3 * out.tick_time, 1e3 * times.draw, 1e3 * times.evaluate, 1e3 * times.guide});
  to.put({1e3 * times.update, 1e3 * times.total, 1e3 * facts.deadline});
  const int lap = laps.laps();
  to.put({static_cast<double>(lap), tick.time - laps.lap_start_time()});
  to.put({laps.progress() / world.track().lap_path()->length() - lap, laps.offset(), clearance_of(world)});
  to.put({tick.seen.collides() ? 1.0 : 0.0, static_cast<double>(tick.collisions), tick.cost.total()});
  to.put({facts.prediction_step, static_cast<double>(facts.method), cost_.state + cost_.collision});
  if (estimate.friction > 0) {
    const double turning = std::abs(out.speed_estimate * out.yaw_rate_estimate);
    to.put({out.slip_estimate, turning / (estimate.friction * gravity), estimate.friction});
    to.put({estimate.cautious_friction, estimate.steering_gain, estimate.steering_offset, estimate.delay});
  } else {
    to.put({none, none, none, none, none, none, none});  // the tyres do not slip
  }
  const maps::Pose& rear = tick.odometry.pose;
  to.put({rear.x, rear.y, rear.yaw, tick.odometry.speed,
          static_cast<double>(solve ? solve->symptom() : Symptom::none)});
  to.end();
  put_scan(to, tick);
  put_cost_map(to, tick);
  put_others(to, tick);
  if (!solve) return to.take();
  put_candidates(to, tick);
  put_guides(to, tick);
  to.begin(Block::nominal);
  to.put(static_cast<std::uint32_t>(states_of(tick.planner, solve->nominal)));
  to.begin_points({car.x, car.y});
  put_states(to, tick.planner, solve->nominal);
  to.end();
  put_plan(to, tick);
  const auto inputs = static_cast<std::size_t>(tick.planner.solver().inputs());
  to.put_covariance(solve->variances, inputs);
  put_inputs(to, *solve, out.inputs, inputs);
  put_effective_samples(to, *solve);
  if (!out.inputs.empty()) put_step_costs(to, step_costs_, 3, states_of(tick.planner, out.inputs));
  return to.take();
}

FrameEncoder::States FrameEncoder::predict(const vehicle::Planner& planner, std::span<const float> inputs) {
  const std::size_t count = states_of(planner, inputs);
  if (states_.size() < count) states_.resize(count);
  const States states(states_.data(), count);
  cost_ = planner.predict(inputs, states);
  return states;
}

/// Keeps the cost of each state by term: distance, yaw and speed, collision.
void FrameEncoder::add_step_costs(States states) {
  vehicle::PredictedCost before;
  for (const PredictedState& state : states) {
    const vehicle::PredictedCost& sum = state.cost;
    const double distance = sum.distance - before.distance;
    step_costs_.insert(step_costs_.end(),
                       {distance, sum.state - before.state - distance, sum.collision - before.collision});
    before = sum;
  }
}

void FrameEncoder::put_states(FrameWriter& to, const vehicle::Planner& planner,
                              std::span<const float> inputs) {
  for (const PredictedState& state : predict(planner, inputs)) to.put_point({state.pose.x, state.pose.y});
}

void FrameEncoder::put_candidates(FrameWriter& to, const ControlStep& tick) {
  const SolveResult& solve = *tick.output.solve;
  if (!solve.samples || solve.costs.empty()) return;
  const SequenceBatch& batch = *solve.samples;
  const int count = std::min(sent_candidates, batch.samples()), steps = batch.steps();
  const int inputs = batch.inputs();
  sequence_.resize(static_cast<std::size_t>(steps * inputs));
  FrameWriter points;  // the points follow the terms, and one prediction makes both
  points.begin_points({tick.seen.pose.x, tick.seen.pose.y});
  to.begin(Block::candidates);
  to.put(static_cast<std::uint16_t>(count));
  to.put(static_cast<std::uint16_t>(steps + 1));
  std::string collided;  // 1 + the first state that collides
  for (int i = 0; i < count; ++i) {
    // Evenly spread over the samples, so that the picture is as dense in every region as they are.
    const auto k = static_cast<int>(std::int64_t{i} * batch.samples() / count);
    for (int row = 0; row < steps * inputs; ++row)
      sequence_[static_cast<std::size_t>(row)] = batch.at(row / inputs, row % inputs, k);
    const States states = predict(tick.planner, sequence_);
    for (const PredictedState& state : states) points.put_point({state.pose.x, state.pose.y});
    add_step_costs(states);
    const auto first =
        std::find_if(states.begin(), states.end(), [](const auto& each) { return each.cost.collided; });
    const auto place =
        first == states.end() ? unknown_place : std::min<std::ptrdiff_t>(1 + (first - states.begin()), 254);
    const auto at = static_cast<std::size_t>(k);
    to.put_f32({cost_.distance, cost_.state - cost_.distance, cost_.collision});
    to.put(solve.costs[at]);
    to.put(at < solve.weights.size() ? solve.weights[at] : 0.0f);
    collided += static_cast<char>(solve.collided[at] ? place : 0);
  }
  to.append(collided);
  to.pad();
  to.append(points.take_blocks());
  to.end();
}

void FrameEncoder::put_guides(FrameWriter& to, const ControlStep& tick) {
  const SolveResult& solve = *tick.output.solve;
  const SequenceList& guides = solve.guides;
  const int path = guides.sequences > 0 ? solve.guide_path.sequences / guides.sequences : 0;
  if (guides.sequences == 0) return;
  const SequenceList& shown = path > 0 ? solve.guide_path : guides;
  const std::size_t length = shown.values.size() / static_cast<std::size_t>(shown.sequences);
  to.begin(Block::guides);
  to.put(static_cast<std::uint16_t>(guides.sequences));
  to.put(static_cast<std::uint16_t>(std::max(1, path)));
  to.put(static_cast<std::uint16_t>(states_of(tick.planner, shown.values.first(length))));
  to.put(std::uint16_t{0});
  to.begin_points({tick.seen.pose.x, tick.seen.pose.y});
  const int sequences = std::max(1, path) * guides.sequences;
  for (int i = 0; i < sequences; ++i)
    put_states(to, tick.planner, shown.values.subspan(static_cast<std::size_t>(i) * length, length));
  to.end();
}

/// Writes the plan with its lateral standard deviation: the solver's variances of the inputs, carried through
/// the model to first order, by a difference quotient for each input.
void FrameEncoder::put_plan(FrameWriter& to, const ControlStep& tick) {
  const auto inputs = tick.output.inputs;
  const auto& plan = tick.output.predicted;
  const auto variances = tick.output.solve->variances;
  constexpr float nudge = 0.01f;  // rad, m/s^2
  const auto width = static_cast<std::size_t>(tick.output.inputs_per_step);
  std::vector<double> spread(plan.size(), 0.0);
  sequence_.assign(inputs.begin(), inputs.end());
  for (std::size_t j = 0; j < inputs.size() && j < variances.size(); ++j) {
    sequence_[j] += nudge;
    const States moved = predict(tick.planner, sequence_);
    sequence_[j] = inputs[j];
    for (std::size_t k = j / width + 1; k < plan.size(); ++k) {
      const maps::Pose& p = plan[k].pose;
      const double across =
          -std::sin(p.yaw) * (moved[k].pose.x - p.x) + std::cos(p.yaw) * (moved[k].pose.y - p.y);
      spread[k] += across * across / static_cast<double>(nudge * nudge) * static_cast<double>(variances[j]);
    }
  }
  to.begin(Block::plan);
  to.put(static_cast<std::uint32_t>(plan.size()));
  to.put(tick.seen.pose.x);
  to.put(tick.seen.pose.y);
  for (std::size_t k = 0; k < plan.size(); ++k) {
    const PredictedState& state = plan[k];
    to.put_f32({state.pose.x - tick.seen.pose.x, state.pose.y - tick.seen.pose.y, state.pose.yaw, state.speed,
                state.steer, std::sqrt(spread[k])});
  }
  to.end();
}

}  // namespace slalom::view
