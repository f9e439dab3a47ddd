// The planner with the options of the published program.
#include <gtest/gtest.h>

#include "slalom/vehicle/planner/planner.hpp"
#include "support/lane.hpp"

namespace slalom::vehicle::published_planner_test {
namespace {

/// Returns the same sequence in every solve, whatever the bounds.
class ConstantSolver final : public Solver {
 public:
  explicit ConstantSolver(float input) : input_(input), inputs_(20, input) {
    result_.inputs = result_.mean = inputs_;
  }
  const char* name() const noexcept override { return "constant"; }
  int horizon() const noexcept override { return 20; }
  int inputs() const noexcept override { return 1; }
  std::unique_ptr<Solver> clone() const override { return std::make_unique<ConstantSolver>(input_); }
  const SolveResult& result() const noexcept override { return result_; }
  const SolveResult& solve(const BatchEvaluator&, const SolveRequest&) noexcept override { return result_; }
  void reset(std::uint64_t) noexcept override {}

 private:
  float input_;
  std::vector<float> inputs_;
  SolveResult result_;
};

struct Steered {
  double command = 0;   ///< rad
  double observed = 0;  ///< rad, of the steering observer after one period
};

/// Drives one period with a solver that plans `angle` (rad).
Steered steer(bool wrap, float angle) {
  const std::vector<float> ranges(271, 20.0f);
  const PlannerInput input{{ranges, -2.35, 4.7 / 270, 0.05, 30}, {{5, 0, 0}, 3}};
  PlannerOptions options;
  options.stop_when_blocked = options.verify_plan = options.back_up = false;
  options.published.wrap_steer = wrap;
  VehicleOptions car;
  car.hold_first_input = true;  // so the observer has no dead time
  Planner planner(options, make_vehicle_model(car), testing::lane(3),
                  std::make_unique<ConstantSolver>(angle));
  const double command = planner.update(input).command.steer;
  return {command, planner.update(input).steer_estimate / (1 - std::exp(-0.25))};
}

TEST(WrapSteer, TakesTurnsOffAndLimitsOnlyTheCommand) {
  const double wrapped = static_cast<double>(static_cast<float>(4 - 2 * M_PI));  // -2.283
  const Steered limited = steer(false, 4), published = steer(true, 4);
  EXPECT_EQ(limited.command, 0.4189);
  EXPECT_NEAR(limited.observed, 0.4189, 1e-12);
  EXPECT_EQ(published.command, -0.4189);
  EXPECT_NEAR(published.observed, wrapped, 1e-12);
}

TEST(WrapSteer, ChangesNoAngleWithinTheLimit) {
  for (const float angle : {-0.41f, 1e-9f, 0.3f}) {
    const Steered published = steer(true, angle);
    EXPECT_EQ(published.command, static_cast<double>(angle));
    EXPECT_NEAR(published.observed, static_cast<double>(angle), 1e-12);
  }
}

TEST(WrapSteer, KeepsTheCommandWithinTheLimitForAnyAngle) {
  for (const float angle : {1e3f, -1e9f, 1e13f, 3e17f}) {
    const double command = steer(true, angle).command;
    EXPECT_LE(std::abs(command), 0.4189) << angle;
  }
}

}  // namespace
}  // namespace slalom::vehicle::published_planner_test
