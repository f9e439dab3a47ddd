#pragma once

#include "slalom/solvers/registry.hpp"
#include "slalom/vehicle/planner/planner.hpp"
#include "solvers/set_option.hpp"
#include "support/adversary.hpp"
#include "support/any_options.hpp"
#include "support/lane.hpp"
#include "support/promise.hpp"

/// Planners as state machines: updates with any scan and odometry, and what every command promises.
namespace slalom::testing {

/// A method's options for short solves of a car.
inline SolverOptions few_samples(const char* method) {
  SolverOptions options = solver_options(method);
  set(options, "horizon", 6);
  set(options, "samples", 32);
  set(options, "input_min", -0.4);
  set(options, "input_max", 0.4);
  return options;
}

/// A planner of a car whose tyres slip, on a lane at 3 m/s.
inline vehicle::Planner sliding_planner(const vehicle::PlannerOptions& options = {},
                                        vehicle::VehicleOptions car = {},
                                        const std::vector<maps::ReferencePoint>& path = lane(3)) {
  car.model = vehicle::vehicle_model("single_track");
  return {options, vehicle::make_vehicle_model(car), path, make_solver(few_samples("svg_mppi"), 2)};
}

inline maps::LaserScanView any_scan(Adversary& adversary, std::vector<float>& ranges) {
  ranges.resize(static_cast<std::size_t>(adversary.below(20) ? 40 : adversary.below(3000)));
  const bool walls = adversary.below(2) != 0;
  for (float& range : ranges)
    range = static_cast<float>(walls ? adversary.within(0.3, 4) : adversary.any(-1, 31));
  if (adversary.below(4)) return {ranges, -2.35, 0.12, 0.05, 30};
  return {ranges, adversary.any(-7, 7), adversary.any(-0.1, 0.1), adversary.any(-1, 1), adversary.any(0, 40)};
}

/// Throws Finding unless a command may be sent to a car with these options.
inline void check_output(const vehicle::PlannerOutput& out, const vehicle::PlannerOptions& options) {
  using vehicle::PlannerStatus;
  require(std::abs(out.command.steer) <= options.steer_limit, "the steering is within its limit");
  require(out.command.speed <= options.max_speed, "the speed is at most the largest");
  const bool slips = out.parameters.friction > 0;  // such cars correct their speed in reverse
  require(out.command.speed >= (slips ? -0.675 : -0.5), "the car backs up slowly");
  if (out.status == PlannerStatus::bad_scan || out.status == PlannerStatus::bad_odometry ||
      out.status == PlannerStatus::off_course)
    require(out.command.speed == 0, "without a plan the car stops");
  require(std::isfinite(out.state_cost) && std::isfinite(out.collision_cost), "costs are finite");
  require(std::isfinite(out.steer_estimate), "the estimate is finite");
  for (const float u : out.inputs) require(std::isfinite(u), "inputs are finite");
  for (const vehicle::PredictedState& s : out.predicted)
    require(std::isfinite(s.pose.x) && std::isfinite(s.pose.y) && std::isfinite(s.speed),
            "predicted states are finite");
}

/// One planner with some options, and up to `most` updates. Returns the number of updates. Throws Finding.
inline int call_planner(Adversary& adversary, int most) {
  vehicle::PlannerOptions options;
  vehicle::VehicleOptions car;
  if (adversary.below(2)) {
    draw_options(adversary, options);
    draw_options(adversary, car);
  }
  options.max_speed = adversary.within(0.01, 20);
  options.steer_limit = adversary.within(0.01, 1.5);
  options.stop_when_blocked = adversary.below(4) != 0;
  options.verify_plan = adversary.below(4) != 0;
  options.back_up = adversary.below(2) != 0;
  options.published.maps = adversary.below(3) == 0;
  options.speed_lookahead = adversary.below(2) ? 0 : adversary.within(0, 2);
  car.model = vehicle::VehicleModelId{adversary.below(static_cast<int>(vehicle::VehicleModels::size))};
  const auto methods = solver_names();
  const char* method = methods[static_cast<std::size_t>(adversary.below(static_cast<int>(methods.size())))];
  std::optional<vehicle::Planner> made;
  try {
    made.emplace(options, vehicle::make_vehicle_model(car), lane(adversary.within(0, 30)),
                 make_solver(few_samples(method), vehicle::input_count(car)));
  } catch (const std::invalid_argument&) {  // options that do not go together
    return 0;
  }
  vehicle::Planner& planner = *made;
  AnyOthers others;
  std::vector<float> ranges;
  std::vector<maps::Point> points;
  int i = 0;
  for (; i < most && !adversary.is_done(); ++i) {
    const maps::LaserScanView scan = any_scan(adversary, ranges);
    points.resize(adversary.below(3) ? 0 : 3);
    for (maps::Point& point : points) point = {adversary.any(-5, 5), adversary.any(-5, 5)};
    const double aside = adversary.below(8) ? 0.5 : 10;
    const bool hostile = adversary.below(4) == 0;
    const auto value = [&](double low, double high) {
      return hostile ? adversary.any(low, high) : adversary.within(low, high);
    };
    vehicle::Odometry odometry{{value(0, 60), aside * value(-1, 1), value(-4, 4)}, value(-1, 12)};
    if (adversary.below(2))
      for (auto& row : odometry.covariance)
        for (double& entry : row) entry = value(-0.01, 0.1);
    vehicle::PlannerInput input{.scan = scan, .odometry = odometry, .obstacles = points};
    if (adversary.below(2)) input.imu = {value(-10, 10), value(-10, 10), value(-10, 10)};
    input.others = others.draw(adversary);
    const CallLimits limits;
    const vehicle::PlannerOutput& out = planner.update(input);
    limits.check();
    check_output(out, options);
    if (!adversary.below(30)) planner.reset(static_cast<std::uint64_t>(i));
  }
  return i;
}

}  // namespace slalom::testing
