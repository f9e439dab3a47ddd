#include "view/protocol/frame.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "slalom/sim/shapes.hpp"
#include "view/protocol/frame_writer.hpp"

namespace slalom::view {
namespace {

using evaluation::ControlStep;
using vehicle::PredictedState;

constexpr const char* names[] = {"tick",
                                 "time",
                                 "x",
                                 "y",
                                 "yaw",
                                 "speed",
                                 "steer",
                                 "yaw_rate",
                                 "slip",
                                 "command_steer",
                                 "command_speed",
                                 "steer_estimate",
                                 "status",
                                 "distance_cost",
                                 "yaw_cost",
                                 "collision_cost",
                                 "minimum_cost",
                                 "expected_cost",
                                 "effective_samples",
                                 "samples",
                                 "collided_share",
                                 "temperature",
                                 "iterations",
                                 "tick_ms",
                                 "draw_ms",
                                 "evaluate_ms",
                                 "guide_ms",
                                 "update_ms",
                                 "solve_ms",
                                 "deadline_ms",
                                 "lap",
                                 "lap_time",
                                 "progress",
                                 "path_distance",
                                 "clearance",
                                 "contact",
                                 "contacts",
                                 "sequence_cost",
                                 "prediction_step",
                                 "method"};

/// Without the head that a message begins with, so that the block can be appended to one.
std::string headless(std::string message) {
  return message.substr(4);
}

/// How many states a sequence of inputs leads through.
std::size_t states_of(const vehicle::Planner& planner, std::span<const float> inputs) {
  return inputs.size() / static_cast<std::size_t>(planner.solver().inputs()) + 1;
}

}  // namespace

std::span<const char* const> scalar_names() noexcept {
  return names;
}

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

std::string FrameEncoder::encode(const ControlStep& tick, const StepFacts& facts) {
  const sim::World& world = tick.world;
  const sim::CarState& car = world.state(0);
  const vehicle::PlannerOutput& out = tick.output;
  const SolveResult* solve = out.solve;
  const sim::LapTimer& laps = *world.laps(0);
  const StageTimes times = solve ? solve->times : StageTimes{};
  cost_ = {};
  if (solve && !out.inputs.empty()) predict(tick.planner, out.inputs);
  const double none = std::numeric_limits<double>::quiet_NaN();
  const std::array<double, std::size(names)> values = {
      static_cast<double>(tick.step),
      tick.time,
      car.x,
      car.y,
      car.yaw,
      car.speed,
      car.steer,
      car.yaw_rate,
      car.slip,
      out.command.steer,
      out.command.speed,
      out.steer_estimate,
      static_cast<double>(out.status),
      cost_.distance,
      cost_.state - cost_.distance,
      cost_.collision,
      solve ? solve->minimum_cost : none,
      solve ? solve->expected_cost : none,
      solve ? solve->effective_sample_size : none,
      solve && solve->samples ? static_cast<double>(solve->samples->samples()) : 0,
      solve ? solve->collided_share : none,
      solve ? solve->temperature : none,
      solve ? static_cast<double>(solve->iterations) : 0,
      1e3 * out.tick_time,
      1e3 * times.draw,
      1e3 * times.evaluate,
      1e3 * times.guide,
      1e3 * times.update,
      1e3 * times.total,
      1e3 * facts.deadline,
      static_cast<double>(laps.laps()),
      tick.time - laps.lap_start_time(),
      laps.progress() / world.track().lap_path()->length() - laps.laps(),
      laps.lateral(),
      clearance_of(world),
      tick.seen.collides() ? 1.0 : 0.0,
      static_cast<double>(tick.collisions),
      tick.cost.total(),
      facts.prediction_step,
      static_cast<double>(facts.method)};

  FrameWriter to;
  to.begin(Block::scalars);
  for (const double value : values) to.put(value);
  to.end();
  put_scan(to, tick);
  put_cost_map(to, tick);
  if (!solve) return to.take();
  put_candidates(to, tick);
  put_guides(to, tick);
  to.begin(Block::nominal);
  to.put(static_cast<std::uint32_t>(states_of(tick.planner, solve->nominal)));
  to.begin_points({car.x, car.y});
  put_states(to, tick.planner, solve->nominal);
  to.end();
  put_plan(to, tick);
  to.begin(Block::covariance);
  const auto width = static_cast<std::size_t>(tick.planner.solver().inputs());
  for (std::size_t row = 0; row < solve->variances.size(); row += width) to.put(solve->variances[row]);
  to.end();
  return to.take();
}

FrameEncoder::States FrameEncoder::predict(const vehicle::Planner& planner, std::span<const float> inputs) {
  const std::size_t count = states_of(planner, inputs);
  if (states_.size() < count) states_.resize(count);
  const States states(states_.data(), count);
  cost_ = planner.predict(inputs, states);
  return states;
}

void FrameEncoder::put_states(FrameWriter& to, const vehicle::Planner& planner,
                              std::span<const float> inputs) {
  for (const PredictedState& state : predict(planner, inputs)) to.put_point({state.pose.x, state.pose.y});
}

void FrameEncoder::put_scan(FrameWriter& to, const ControlStep& tick) const {
  to.begin(Block::scan);
  to.put_pose(tick.seen.sensor);
  to.put(static_cast<std::uint32_t>(tick.scan.ranges.size()));
  for (const float range : tick.scan.ranges) {
    const double millimetres = std::clamp(1000.0 * static_cast<double>(range), 0.0, 65535.0);
    to.put(static_cast<std::uint16_t>(millimetres));
  }
  to.end();
}

void FrameEncoder::put_cost_map(FrameWriter& to, const ControlStep& tick) const {
  const maps::LocalCostMap& map = tick.planner.cost_map();
  const maps::GridGeometry& geometry = map.geometry();
  to.begin(Block::cost_map);
  to.put_pose(tick.odometry.pose);
  to.put(static_cast<std::uint16_t>(geometry.rows));
  to.put(static_cast<std::uint16_t>(geometry.columns));
  to.put_f32(geometry.resolution);
  to.put_f32(geometry.center_x);
  to.put_f32(geometry.center_y);
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

void FrameEncoder::put_candidates(FrameWriter& to, const ControlStep& tick) {
  const SolveResult& solve = *tick.output.solve;
  if (!solve.samples || solve.costs.empty()) return;
  const SequenceBatch& batch = *solve.samples;
  const int count = std::min(most_candidates_, batch.samples()), steps = batch.steps();
  const int inputs = batch.inputs();
  // Evenly spread over the samples, so that the picture is as dense in every region as they are.
  const auto chosen = [&](int i) {
    return static_cast<int>(static_cast<long long>(i) * batch.samples() / count);
  };
  sequence_.resize(static_cast<std::size_t>(steps * inputs));
  FrameWriter points;  // the points follow the terms, and one prediction makes both
  points.begin_points({tick.seen.pose.x, tick.seen.pose.y});
  to.begin(Block::candidates);
  to.put(static_cast<std::uint16_t>(count));
  to.put(static_cast<std::uint16_t>(steps + 1));
  for (int i = 0; i < count; ++i) {
    const int k = chosen(i);
    for (int row = 0; row < steps * inputs; ++row)
      sequence_[static_cast<std::size_t>(row)] = batch.at(row / inputs, row % inputs, k);
    put_states(points, tick.planner, sequence_);
    const auto at = static_cast<std::size_t>(k);
    to.put_f32(cost_.distance);
    to.put_f32(cost_.state - cost_.distance);
    to.put_f32(cost_.collision);
    to.put(solve.costs[at]);
    to.put(at < solve.weights.size() ? solve.weights[at] : 0.0f);
  }
  for (int i = 0; i < count; ++i) to.put(solve.collided[static_cast<std::size_t>(chosen(i))]);
  to.pad();
  to.append(headless(points.take()));
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

/// The plan with its lateral standard deviation: the solver's variances of the inputs, carried through the
/// model to first order, by a difference quotient for each input.
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
    for (const double value : {state.pose.x - tick.seen.pose.x, state.pose.y - tick.seen.pose.y,
                               state.pose.yaw, state.speed, state.steer, std::sqrt(spread[k])})
      to.put_f32(value);
  }
  to.end();
}

std::string encode_bodies(const sim::World& world) {
  FrameWriter to;
  to.begin(Block::bodies);
  to.put(static_cast<std::uint32_t>(world.bodies()));
  const sim::Observation seen = world.observe(0);
  for (std::size_t i = 0; i < world.bodies(); ++i) {
    const sim::Box box = world.outline(i);
    const bool is_car = box.length == world.options().car.length && box.width == world.options().car.width;
    const int kind = i == 0 ? 0 : i < world.cars() ? 4 : world.disc(i) ? 3 : is_car ? 1 : 2;
    const bool touched = i == 0 ? seen.collides()
                                : std::find(seen.colliding.begin(), seen.colliding.end(),
                                            static_cast<int>(i)) != seen.colliding.end();
    to.put(static_cast<std::uint16_t>(i));
    to.put(static_cast<std::uint8_t>(kind));
    to.put(static_cast<std::uint8_t>(touched));
    for (const double value : {box.pose.x, box.pose.y, box.pose.yaw, box.length, box.width})
      to.put_f32(value);
  }
  to.end();
  return headless(to.take());
}

std::string encode_ghost(const sim::World& world, std::span<const maps::Pose> plan) {
  const sim::CarState& car = world.state(0);
  FrameWriter to;
  to.begin(Block::ghost);
  to.put_pose({car.x, car.y, car.yaw});
  to.put(car.steer);
  to.put(car.speed);
  to.put(world.laps(0)->progress() / world.track().lap_path()->length());
  to.put(world.laps(0)->last_lap_time());
  to.put(static_cast<std::uint32_t>(plan.size()));
  to.begin_points({car.x, car.y});
  for (const maps::Pose& pose : plan) to.put_point({pose.x, pose.y});
  to.end();
  return headless(to.take());
}

std::string encode_scene(const evaluation::Environment& environment) {
  const maps::OccupancyGrid& grid = environment.course.map;
  std::vector<std::uint32_t> runs;  // value in the upper 8 bits, length in the lower 24
  for (const maps::Occupancy cell : grid.cells) {
    const auto value = static_cast<std::uint32_t>(cell);
    if (runs.empty() || runs.back() >> 24 != value || (runs.back() & 0xffffffu) == 0xffffffu)
      runs.push_back(value << 24);
    ++runs.back();
  }
  FrameWriter to;
  to.begin(Block::grid);
  to.put(static_cast<std::uint32_t>(grid.width));
  to.put(static_cast<std::uint32_t>(grid.height));
  to.put(grid.resolution);
  to.put_pose(grid.origin);
  to.put(static_cast<std::uint32_t>(runs.size()));
  for (const std::uint32_t run : runs) to.put(run);
  to.end();
  to.begin(Block::path);
  to.put(static_cast<std::uint32_t>(environment.path.size()));
  to.put(static_cast<std::uint32_t>(environment.course.closed));
  for (const maps::ReferencePoint& point : environment.path)
    for (const double value : {point.x, point.y, point.speed}) to.put_f32(value);
  to.end();
  return to.take();
}

}  // namespace slalom::view
