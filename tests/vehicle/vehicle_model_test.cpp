// Properties of every registered vehicle model.
#include "slalom/vehicle/model/vehicle_model.hpp"

#include <set>

#include "slalom/core/option_access.hpp"
#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/reference_field.hpp"
#include "slalom/solvers/mppi_options.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/model/problem_model.hpp"
#include "slalom/vehicle/planner/planner.hpp"
#include "solvers/closed_form.hpp"
#include "support/lane.hpp"
#include "support/thrown_words.hpp"

namespace slalom::vehicle::vehicle_model_test {
namespace {

std::vector<std::string> model_names() {
  return {VehicleModels::names.begin(), VehicleModels::names.end() - 1};
}

VehicleOptions options_of(const std::string& name) {
  VehicleOptions options;
  options.model = vehicle_model(name);
  return options;
}

const std::vector<maps::ReferencePoint> lane = testing::lane(3);

class VehicleModelContract : public ::testing::TestWithParam<std::string> {
 protected:
  VehicleModelContract() : field_(lane), model_(make_vehicle_model(options_of(GetParam()))) {
    field_.update({5, 0});
    const std::vector<maps::Point> obstacle = {{3, 0.4}};
    clearance_.add(obstacle);
    inflated_.add_points(obstacle);
    const bool clearance = model_->traits().obstacles.map == ObstacleMap::clearance;
    model_->set_maps({field_.view(), clearance ? clearance_.view() : inflated_.view(), {5, 0.2, 0.1}});
  }

  maps::ReferenceField field_;
  maps::ClearanceMap clearance_;
  maps::LocalCostMap inflated_{maps::LocalCostMapOptions{.outside = -1}};
  std::unique_ptr<VehicleModel> model_;
};

TEST_P(VehicleModelContract, HasTheTraitsAndInputsThatItsOptionsSay) {
  const VehicleOptions options = options_of(GetParam());
  const VehicleTraits traits = model_->traits();
  EXPECT_EQ(model_->inputs(), input_count(options));
  EXPECT_EQ(model_->evaluator().inputs(), model_->inputs());
  EXPECT_EQ(traits.time_step, options.time_step);
  EXPECT_EQ(traits.time_step, model_->evaluator().time_step());
  EXPECT_GT(traits.wheelbase, 0);
  EXPECT_GT(traits.max_deceleration, 0);
  if (traits.obstacles.map == ObstacleMap::clearance) {
    EXPECT_GT(traits.obstacles.reach, 0);
  }
}

TEST_P(VehicleModelContract, PredictsTheStartFirstAndKeepsItsTurns) {
  const int steps = 10, inputs = model_->inputs();
  const VehicleStart start{{5, 0.2, 0.1}, 2, 0.05};
  model_->set_start(start, 3);
  const auto end = [&](float steer) {
    std::vector<float> sequence(static_cast<std::size_t>(steps * inputs), 0);
    for (int k = 0; k < steps; ++k) sequence[k * inputs] = steer;
    std::vector<PredictedState> states(static_cast<std::size_t>(steps) + 1);
    const PredictedCost cost = model_->predict(sequence, states);
    EXPECT_TRUE(std::isfinite(cost.state) && std::isfinite(cost.collision));
    EXPECT_GE(cost.state, cost.distance - 1e-9);
    EXPECT_EQ(states[0].pose.x, start.pose.x);
    EXPECT_EQ(states[0].pose.y, start.pose.y);
    EXPECT_EQ(states[0].pose.yaw, start.pose.yaw);
    EXPECT_EQ(states[0].speed, start.speed);
    EXPECT_EQ(states[0].steer, start.steer);
    EXPECT_NEAR(states[0].local.x, 0, 1e-9) << "the robot's frame is where the car is";
    return states.back();
  };
  const PredictedState left = end(0.3f), right = end(-0.3f);
  EXPECT_GT(left.pose.yaw, right.pose.yaw + 0.3);
  EXPECT_GT(left.pose.x, 5.5);
}

TEST_P(VehicleModelContract, RolloutsCostWhatIsPredicted) {
  const int steps = 12, samples = 16, inputs = model_->inputs();
  SequenceBatch batch(steps, inputs, samples);
  for (int k = 0; k < samples; ++k)
    for (int t = 0; t < steps; ++t) {
      batch.at(t, 0, k) = static_cast<float>(0.02 * (k - 8) + 0.01 * t);
      if (inputs > 1) batch.at(t, 1, k) = static_cast<float>(0.3 * (k - 8));
    }
  std::vector<float> costs(samples), sequence(static_cast<std::size_t>(steps * inputs));
  std::vector<std::uint8_t> collided(samples);
  std::vector<PredictedState> states(static_cast<std::size_t>(steps) + 1);
  model_->set_start({{5, 0.2, 0.1}, 2, 0.05}, 3);
  model_->evaluator().evaluate(batch, 0, samples, costs.data(), collided.data());
  int differing = 0;
  for (int k = 0; k < samples; ++k) {
    for (int t = 0; t < steps; ++t)
      for (int i = 0; i < inputs; ++i) sequence[t * inputs + i] = batch.at(t, i, k);
    const PredictedCost cost = model_->predict(sequence, states);
    const double expected = cost.state + cost.collision, got = static_cast<double>(costs[k]);
    differing += std::abs(got - expected) > 1e-3 * std::max(1.0, expected);
  }
  EXPECT_LE(differing, 2) << "a position at an edge between two cells of a map may be in either";
}

TEST_P(VehicleModelContract, IsDrivenByThePlanner) {
  Configuration configuration;
  set_option(configuration, "vehicle.model", GetParam());
  set_option(configuration, "mppi.input_min", "-0.4");
  set_option(configuration, "mppi.input_max", "0.4");
  set_option(configuration, "mppi.samples", "256");
  set_option(configuration, "vehicle.outside_cost", "0");
  set_option(configuration, "vehicle.outside_terminal_cost", "0");
  Planner planner(configuration.planner, make_vehicle_model(configuration.vehicle), lane,
                  make_solver(configuration, "mppi", 1));
  std::vector<float> ranges(271, 20.0f);
  for (int i = 0; i < 5; ++i) {
    const PlannerOutput& out = planner.update({{ranges, -2.35, 4.7 / 270, 0.05, 30}, {{5, 0, 0}, 3}});
    EXPECT_EQ(out.status, PlannerStatus::ok);
    EXPECT_EQ(out.inputs_per_step, model_->inputs());
    EXPECT_GT(out.command.speed, 2.5);
    EXPECT_LE(std::abs(out.command.steer), 0.4);
  }
}

INSTANTIATE_TEST_SUITE_P(Registered, VehicleModelContract, ::testing::ValuesIn(model_names()),
                         [](const auto& name) { return name.param; });

TEST(VehicleModels, HaveNamesAndOptionsOfTheirOwn) {
  std::set<std::string> names, options;
  for (const std::string& name : model_names()) EXPECT_TRUE(names.insert(name).second) << name;
  for (const OptionEntry& entry : list_options(VehicleOptions{}))
    EXPECT_TRUE(options.insert(entry.declaration.name).second) << entry.declaration.name;
}

TEST(VehicleModels, RejectUnknownNamesAndOptionsOfOtherModels) {
  const std::string unknown = message_of([] { vehicle_model("tricycle"); });
  EXPECT_EQ(unknown.rfind("vehicle.model: 'tricycle' must be one of kinematic, ", 0), 0u) << unknown;
  for (const std::string& name : model_names()) EXPECT_NE(unknown.find(name), std::string::npos) << name;
  VehicleOptions options;
  options.own_of<published::ModelOptions>().exact_lag = false;
  EXPECT_EQ(message_of([&] { make_vehicle_model(options); }),
            "vehicle.exact_lag: 'false' is an option of vehicle.model 'published', but vehicle.model is "
            "'kinematic'");
  options.model = vehicle_model("published");
  EXPECT_EQ(message_of([&] { make_vehicle_model(options); }), "accepted");
  options.time_step = 0;
  EXPECT_NE(message_of([&] { make_vehicle_model(options); }).find("vehicle.time_step"), std::string::npos);
}

/// A point that moves along x at 1 m/s, whatever its inputs, without maps.
struct Trolley {
  template <class T>
  struct State {
    T x;
  };
  static constexpr int inputs = 1;
  double dt = 0.1;
  template <class T>
  State<T> step(const State<T>& s, const Input<T, 1>&) const {
    return {s.x + T(dt)};
  }
  template <class T>
  Cost<T> stage_cost(const State<T>&, const Input<T, 1>& u) const {
    return {u[0] * u[0], mask_t<T>(false)};
  }
  void set_maps(const VehicleMaps&) {}
  State<double> start(const VehicleStart& start, double) { return {start.pose.x}; }
  PredictedState predicted(const State<double>& s) const { return {{s.x, 0, 0}, 1, 0, {}}; }
  double collision_part(NoLookUp, bool) const { return 0; }
  double distance_part(NoLookUp, bool) const { return 0; }
  VehicleTraits traits() const {
    return {.time_step = dt, .wheelbase = 1, .max_deceleration = 1, .speed = {.planned = true}};
  }
};
static_assert(VehicleProblem<Trolley>);

TEST(ProblemModel, LetsThePlannerDriveAnyVehicleProblem) {
  MppiOptions method = testing::with_control_term(1);
  method.horizon = 10;
  method.samples = 128;
  Planner planner({}, std::make_unique<ProblemModel<Trolley>>(Trolley{}), lane, make_solver(method, 1));
  std::vector<float> ranges(271, 20.0f);
  const PlannerOutput& out = planner.update({{ranges, -2.35, 4.7 / 270, 0.05, 30}, {{5, 0, 0}, 3}});
  EXPECT_EQ(out.status, PlannerStatus::ok);
  EXPECT_EQ(out.command.speed, 1) << "that of the plan";
  EXPECT_NEAR(out.predicted.back().pose.x, 6, 1e-9);
}

}  // namespace
}  // namespace slalom::vehicle::vehicle_model_test
