#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "slalom/core/polymorphic.hpp"
#include "slalom/maps/reference_field.hpp"
#include "slalom/vehicle/planner/planner.hpp"
#include "vehicle/planner/obstacles/obstacles.hpp"
#include "vehicle/planner/sequence_choice.hpp"

namespace slalom::vehicle::detail {

/// The parts of which a planner is made.
struct PlannerParts {
  const PlannerOptions& options;
  std::unique_ptr<VehicleModel> model;
  maps::Point origin;                      ///< m, map frame; origin of the frame of all computations
  std::vector<maps::ReferencePoint> path;  ///< in the frame that begins at `origin`
  std::unique_ptr<Solver> solver;
};

/// The parts and steps that two planners share: KinematicPlanner for a car whose tyres do not slip, and
/// DynamicPlanner for a car whose tyres slip. A copy shares only threads with the original.
class PlannerBase {
 public:
  /// Takes model and solver out of the parts.
  explicit PlannerBase(PlannerParts& parts);
  virtual ~PlannerBase() = default;
  virtual std::unique_ptr<PlannerBase> clone() const = 0;

  const PlannerOutput& update(const PlannerInput& input) noexcept;
  void reset(std::uint64_t seed) noexcept;
  PredictedCost predict(std::span<const float> inputs, std::span<PredictedState> states) const noexcept;
  const Solver& solver() const noexcept { return *solver_; }
  const maps::LocalCostMap& cost_map() const noexcept { return obstacles_.cost_map(); }

  /// Makes rollouts use the maps of this object. Call it on a copy, whose model has those of the original.
  void take_own_maps() noexcept;

 protected:
  /// Plans from scan and odometry. The pose is relative to `origin_`.
  virtual void plan(const PlannerInput& input) noexcept = 0;
  /// Completes the output's command, and records which one the car obeys: this one, or another.
  virtual void send(const std::optional<Command>& obeyed) noexcept = 0;
  /// Forgets the state of the derived planner, for `reset`.
  virtual void forget() noexcept = 0;
  /// The angle of the wheels now, rad.
  virtual double steer_estimate() const noexcept = 0;
  /// The lowest speed of a command now, m/s.
  virtual double slowest() const noexcept = 0;
  /// The field that plans follow.
  virtual GridView<4> followed() const noexcept { return field_.view(); }

  /// Commands a stop at the present angle of the wheels, without a plan.
  void stop(PlannerStatus status) noexcept;
  /// Whether the car is further from the path than the field reaches, and must stop.
  bool must_stop(const maps::ReferenceCell& here) const noexcept;
  /// Lets rollouts begin at `start`, among the obstacles of a scan from `robot`. `path_speed` (m/s) is the
  /// speed of the path there.
  void begin_rollouts(const maps::Pose& robot, const VehicleStart& start, double path_speed) noexcept;
  /// Solves the problem and sets the status of the output.
  const SolveResult& solve() noexcept;
  /// Writes the chosen sequence and its prediction into the output.
  void publish() noexcept;
  /// The duration of a plan, s.
  double horizon_time() const noexcept { return traits_.time_step * solver_->horizon(); }

  PlannerOptions options_;
  maps::Point origin_;  ///< origin of the frame of all computations, in the map frame
  Polymorphic<VehicleModel> model_;
  VehicleTraits traits_;
  Polymorphic<Solver> solver_;
  double stopping_time_;  ///< s by which maps reach beyond plans, to stop at the given friction
  double reach_;          ///< m; how far the maps reach
  Obstacles obstacles_;
  maps::ReferenceField field_;
  SequenceChoice choice_;
  double top_speed_ = options_.max_speed;  ///< m/s, with the goal speed of the last input
  bool brakes_ = false;                    ///< the command must not be faster than the car
  PlannerOutput output_;

 private:
  /// The arguments of the last `begin_rollouts`.
  struct Rollouts {
    maps::Pose robot;
    VehicleStart start;
    double path_speed = 0;  ///< m/s
  };

  int check_command(const Odometry& odometry, double wheels) noexcept;
  void check_output(const Odometry& odometry) noexcept;

  std::optional<Rollouts> rollouts_;
};

/// Makes the planner of a car whose tyres do not slip.
std::unique_ptr<PlannerBase> make_kinematic_planner(PlannerParts& parts);
/// Makes the planner of a car whose tyres slip; the model is a DynamicVehicleModel.
std::unique_ptr<PlannerBase> make_dynamic_planner(PlannerParts& parts);

}  // namespace slalom::vehicle::detail
