#include "slalom/evaluation/sequence_cost.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/reference_field.hpp"
#include "vehicle/car_rollout.hpp"

namespace slalom::evaluation {

namespace {

using vehicle::PathTrackingOptions;
using vehicle::PredictedState;
using vehicle::detail::CarRollout;
using Problem = vehicle::PathTracking<true>;
using Ruler = std::array<PredictedState, SequenceCostMeter::states>;

constexpr int steps = SequenceCostMeter::states - 1;

maps::LocalCostMapOptions cost_map_options() {
  auto options = maps::LocalCostMapOptions::published();
  options.outside = -1;  // so that the problem can tell "off the map" from "occupied"
  return options;
}

maps::Pose between(const maps::Pose& a, const maps::Pose& b, double part) {
  return {a.x + part * (b.x - a.x), a.y + part * (b.y - a.y), a.yaw + part * maps::wrap_angle(b.yaw - a.yaw)};
}

/// States 0.05 s apart out of ones `spacing` (s) apart, which reach far enough.
Ruler resampled(std::span<const PredictedState> predicted, double spacing) {
  Ruler ruler;
  for (int k = 0; k <= steps; ++k) {
    const double at = k * SequenceCostMeter::time_step / spacing, whole = std::floor(at + 1e-9);
    const double part = std::max(at - whole, 0.0);
    const auto i = std::min(static_cast<std::size_t>(whole), predicted.size() - 1);
    ruler[static_cast<std::size_t>(k)] = predicted[i];
    if (part < 1e-9 || i + 1 >= predicted.size()) continue;
    ruler[static_cast<std::size_t>(k)].pose = between(predicted[i].pose, predicted[i + 1].pose, part);
    ruler[static_cast<std::size_t>(k)].local = between(predicted[i].local, predicted[i + 1].local, part);
  }
  return ruler;
}

}  // namespace

PathTrackingOptions published_problem() {
  PathTrackingOptions options;
  options.front_length = 0.189;
  options.rear_length = 0.135;
  options.bicycle = vehicle::BicycleForm::published;
  options.outside_terminal_cost = 10;
  options.body = vehicle::BodyForm::box;
  options.limit_acceleration = false;
  options.exact_lag = false;
  options.hold_first_input = true;
  options.straight_local_rollout = true;
  options.linear_sign_error = true;
  return options;
}

struct SequenceCostMeter::Implementation {
  PathTrackingOptions model;
  Problem ruler{published_problem()};
  maps::LocalCostMap cost_map{cost_map_options()};
  maps::ReferenceField field;
  std::unique_ptr<CarRollout> own, published;
  std::vector<float> inputs;
  std::vector<PredictedState> states;
  maps::Pose robot;

  Implementation(std::span<const maps::ReferencePoint> path, const PathTrackingOptions& m)
      : model(m),
        field(path, maps::ReferenceFieldOptions::published()),
        own(CarRollout::make(m)),
        published(CarRollout::make(published_problem())),
        inputs(static_cast<std::size_t>(std::ceil(steps * time_step / m.time_step - 1e-9))),
        states(std::max<std::size_t>(inputs.size(), steps) + 1) {}

  Problem::State<double> state_of(const PredictedState& p) const {
    Problem::State<double> s{};
    s.x = p.pose.x;
    s.y = p.pose.y;
    s.yaw = p.pose.yaw;
    s.local_x = p.local.x;
    s.local_y = p.local.y;
    s.local_yaw = p.local.yaw;
    return s;
  }

  Cost cost_of(const Problem::State<double>& s, bool last) const {
    const auto seen = ruler.look_up(s);
    const auto& options = ruler.options();
    const double collision =
        ruler.collision_cost(seen, last ? options.outside_terminal_cost : options.outside_cost);
    const auto both = last ? ruler.terminal_cost(s, seen) : ruler.stage_cost(s, seen, Input<double, 1>{});
    return {both.value - collision, collision};
  }

  Cost cost_of(const Ruler& sequence) const {
    Cost sum;
    for (int k = 0; k <= steps; ++k) {
      const Cost cost = cost_of(state_of(sequence[static_cast<std::size_t>(k)]), k == steps);
      sum.state += cost.state;
      sum.collision += cost.collision;
    }
    return sum;
  }

  /// The sequence sent, an input every `spacing` (s), the last one held.
  std::span<const float> held(const vehicle::PlannerOutput& output, std::size_t count, double spacing) {
    for (std::size_t k = 0; k < count; ++k) {
      const auto i = static_cast<std::size_t>(static_cast<double>(k) * spacing / model.time_step + 1e-9);
      inputs[k] = output.inputs[std::min(i, output.inputs.size() - 1)];
    }
    return {inputs.data(), count};
  }

  Ruler predict(CarRollout& rollout, const vehicle::PlannerOutput& output, std::span<const float> sequence,
                double spacing) {
    const PredictedState& first = output.predicted.front();
    rollout.set_maps(field.view(), cost_map.view(), robot);
    rollout.set_start({first.pose, first.speed, first.steer}, field.at(first.pose.x, first.pose.y).speed);
    const std::span<PredictedState> reached(states.data(), sequence.size() + 1);
    rollout.predict(sequence, reached);
    return resampled(reached, spacing);
  }
};

SequenceCostMeter::SequenceCostMeter(std::span<const maps::ReferencePoint> path,
                                     const PathTrackingOptions& model)
    : implementation_(std::make_unique<Implementation>(path, model)) {
  implementation_->inputs.resize(std::max<std::size_t>(implementation_->inputs.size(), steps));
}
SequenceCostMeter::~SequenceCostMeter() = default;
SequenceCostMeter::SequenceCostMeter(SequenceCostMeter&&) noexcept = default;
SequenceCostMeter& SequenceCostMeter::operator=(SequenceCostMeter&&) noexcept = default;

void SequenceCostMeter::observe(const maps::LaserScanView& scan, const maps::Pose& robot) noexcept {
  Implementation& m = *implementation_;
  m.robot = robot;
  m.cost_map.update(scan);
  m.field.update({robot.x, robot.y});
  m.ruler.set_maps(m.field.view(), m.cost_map.view(), robot.x, robot.y, robot.yaw);
}

SequenceCostMeter::Cost SequenceCostMeter::planned(const vehicle::PlannerOutput& output) noexcept {
  Implementation& m = *implementation_;
  if (output.predicted.empty()) return present();
  const double reached = static_cast<double>(output.predicted.size() - 1) * m.model.time_step;
  if (reached >= steps * time_step - 1e-9) return m.cost_of(resampled(output.predicted, m.model.time_step));
  const auto count = m.states.size() - 1;
  const auto needed = static_cast<std::size_t>(std::ceil(steps * time_step / m.model.time_step - 1e-9));
  return m.cost_of(m.predict(*m.own, output, m.held(output, std::min(needed, count), m.model.time_step),
                             m.model.time_step));
}

SequenceCostMeter::Cost SequenceCostMeter::published_model(const vehicle::PlannerOutput& output) noexcept {
  Implementation& m = *implementation_;
  if (output.predicted.empty()) return present();
  return m.cost_of(m.predict(*m.published, output, m.held(output, steps, time_step), time_step));
}

SequenceCostMeter::Cost SequenceCostMeter::present() const noexcept {
  const Implementation& m = *implementation_;
  PredictedState here;
  here.pose = m.robot;
  const Cost cost = m.cost_of(m.state_of(here), false);
  return {states * cost.state, states * cost.collision};
}

double SequenceCostMeter::path_distance() const noexcept {
  const Implementation& m = *implementation_;
  return m.field.at(m.robot.x, m.robot.y).distance;
}

}  // namespace slalom::evaluation
