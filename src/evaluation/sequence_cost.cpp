#include "slalom/evaluation/sequence_cost.hpp"

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/reference_field.hpp"
#include "slalom/vehicle/published/options.hpp"

namespace slalom::evaluation {

namespace {

using vehicle::PredictedState;
using vehicle::VehicleModel;
using vehicle::VehicleOptions;
using Problem = vehicle::published::TwoTrajectories;
/// The states that a cost is summed over, 0.05 s apart.
using MeasuredStates = std::array<PredictedState, SequenceCostMeter::states>;

constexpr int steps = SequenceCostMeter::states - 1;

maps::LocalCostMapOptions cost_map_options() {
  auto options = maps::published_cost_map();
  options.outside = -1;  // so that the problem distinguishes "off the map" from "occupied"
  return options;
}

maps::Pose between(const maps::Pose& a, const maps::Pose& b, double part) {
  return {a.x + part * (b.x - a.x), a.y + part * (b.y - a.y), a.yaw + part * maps::wrap_angle(b.yaw - a.yaw)};
}

/// States 0.05 s apart, interpolated from states `spacing` (s) apart. Beyond the last one it is repeated.
MeasuredStates resampled(std::span<const PredictedState> predicted, double spacing) {
  MeasuredStates result;
  for (int k = 0; k <= steps; ++k) {
    const double at = k * SequenceCostMeter::time_step / spacing, whole = std::floor(at + 1e-9);
    const double part = std::max(at - whole, 0.0);
    const auto i = std::min(saturate_cast<std::size_t>(whole), predicted.size() - 1);
    PredictedState& state = result[static_cast<std::size_t>(k)];
    state = predicted[i];
    if (part < 1e-9 || i + 1 >= predicted.size()) continue;
    state.pose = between(predicted[i].pose, predicted[i + 1].pose, part);
    state.local = between(predicted[i].local, predicted[i + 1].local, part);
  }
  return result;
}

}  // namespace

struct SequenceCostMeter::Implementation {
  std::vector<maps::ReferencePoint> path;
  VehicleOptions model;
  /// Has the weights and costs of the paper's program.
  Problem problem{vehicle::published::vehicle_options(), vehicle::published::ModelOptions::published()};
  maps::LocalCostMap cost_map{cost_map_options()};
  maps::ReferenceField field;
  std::unique_ptr<VehicleModel> rollout;
  std::vector<PredictedState> states;  ///< predicted states, as many as a cost needs
  std::vector<float> inputs;
  maps::Pose robot;
  GridView<1> obstacles;  ///< obstacles of this cost map or of the caller's
  double reach = 0;       ///< m, how far along either axis the field is up to date

  Implementation(std::span<const maps::ReferencePoint> along, const VehicleOptions& m)
      : path(along.begin(), along.end()),
        model(m),
        field(along, maps::published_reference_field()),
        rollout(make_vehicle_model(m)),
        states(saturate_cast<std::size_t>(std::ceil(steps * time_step / m.time_step - 1e-9)) + 1),
        inputs((states.size() - 1) * static_cast<std::size_t>(rollout->inputs())) {}

  Cost cost_of(const PredictedState& predicted, bool last) const {
    const auto s = Problem::standing_at(predicted);
    const auto seen = problem.look_up(s);
    const double collision = problem.collision_part(seen, last);
    const auto both = last ? problem.terminal_cost(s, seen) : problem.stage_cost(s, seen, Input<double, 1>{});
    return {both.value - collision, collision};
  }

  /// m, along either axis, from the robot to the farthest of these states.
  double extent(std::span<const PredictedState> sequence) const noexcept {
    double most = 0;
    for (const PredictedState& state : sequence)
      most = std::max({most, std::abs(state.pose.x - robot.x), std::abs(state.pose.y - robot.y)});
    return most;
  }
  /// Updates the field as far as `needed` and `margin` (m) more, unless it is up to date that far.
  void make_field(double needed, double margin) noexcept {
    if (needed <= reach) return;
    reach = needed + margin;
    field.update(robot, reach);
  }

  Cost cost_of(const MeasuredStates& sequence) noexcept {
    make_field(extent(sequence), 0.2);
    Cost sum;
    for (int k = 0; k <= steps; ++k) {
      const Cost cost = cost_of(sequence[static_cast<std::size_t>(k)], k == steps);
      sum.state += cost.state;
      sum.collision += cost.collision;
    }
    return sum;
  }

  /// The states of the planner's sequence from the first state of its own prediction on. Its last input is
  /// held until the sequence is long enough.
  MeasuredStates predict(const vehicle::PlannerOutput& output) {
    const PredictedState& first = output.predicted.front();
    const auto width = static_cast<std::size_t>(rollout->inputs());
    for (std::size_t k = 0; k + 1 < states.size(); ++k)
      std::copy_n(&output.inputs[std::min(k, output.inputs.size() / width - 1) * width], width,
                  &inputs[k * width]);
    // The states are not known in advance. They are usually close to the planner's own prediction; if not,
    // the prediction is repeated with the whole field.
    make_field(extent(output.predicted), 0.5);
    while (true) {
      rollout->set_maps({field.view(), obstacles, robot});
      rollout->set_start({first.pose, first.speed, first.steer}, field.at(first.pose.x, first.pose.y).speed);
      rollout->predict(inputs, states);
      if (extent(states) <= reach) return resampled(states, model.time_step);
      make_field(std::numeric_limits<double>::infinity(), 0);
    }
  }
};

SequenceCostMeter::SequenceCostMeter(std::span<const maps::ReferencePoint> path, const VehicleOptions& model)
    : implementation_(std::make_unique<Implementation>(path, model)) {}
SequenceCostMeter::~SequenceCostMeter() = default;
SequenceCostMeter::SequenceCostMeter(const SequenceCostMeter& other)
    : SequenceCostMeter(other.implementation_->path, other.implementation_->model) {}
SequenceCostMeter& SequenceCostMeter::operator=(const SequenceCostMeter& other) {
  return *this = SequenceCostMeter(other);
}
SequenceCostMeter::SequenceCostMeter(SequenceCostMeter&&) noexcept = default;
SequenceCostMeter& SequenceCostMeter::operator=(SequenceCostMeter&&) noexcept = default;

void SequenceCostMeter::observe(const maps::LaserScanView& scan, const maps::Pose& robot,
                                const maps::LocalCostMap* made) noexcept {
  constexpr double about_the_car = 0.5;  // m
  Implementation& m = *implementation_;
  m.robot = robot;
  if (!made) m.cost_map.update(scan);
  m.obstacles = made ? made->view() : m.cost_map.view();
  m.reach = about_the_car;
  m.field.update(robot, m.reach);
  m.problem.set_maps({m.field.view(), m.obstacles, robot});
}

SequenceCostMeter::Cost SequenceCostMeter::planned(const vehicle::PlannerOutput& output) noexcept {
  Implementation& m = *implementation_;
  if (output.predicted.empty()) return present();
  const double reached = static_cast<double>(output.predicted.size() - 1) * m.model.time_step;
  if (reached >= steps * time_step - 1e-9) return m.cost_of(resampled(output.predicted, m.model.time_step));
  return m.cost_of(m.predict(output));
}

SequenceCostMeter::Cost SequenceCostMeter::present() const noexcept {
  const Implementation& m = *implementation_;
  PredictedState here;
  here.pose = m.robot;
  const Cost cost = m.cost_of(here, false);
  return {states * cost.state, states * cost.collision};
}

double SequenceCostMeter::path_distance() const noexcept {
  const Implementation& m = *implementation_;
  return m.field.at(m.robot.x, m.robot.y).distance;
}

}  // namespace slalom::evaluation
