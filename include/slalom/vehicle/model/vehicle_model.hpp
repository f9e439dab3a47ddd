#pragma once

#include <memory>
#include <span>

#include "slalom/core/batch_evaluator.hpp"
#include "slalom/core/instruction_set.hpp"
#include "slalom/maps/command.hpp"
#include "slalom/vehicle/model/single_track_dynamics.hpp"
#include "slalom/vehicle/model/vehicle_options.hpp"
#include "slalom/vehicle/model/vehicle_problem.hpp"

namespace slalom::vehicle {

/// The cost of a predicted sequence, by term.
struct PredictedCost {
  double state = 0;       ///< cost of distance, yaw and speed, without collisions
  double distance = 0;    ///< the part of `state` that the distance to the path makes
  double collision = 0;   ///< cost of collisions and nearness to obstacles
  bool collided = false;  ///< a state after the first free one collides, or none is free
};

/// A vehicle problem whose type is not known: what the planner drives with.
class VehicleModel {
 public:
  virtual ~VehicleModel() = default;

  virtual int inputs() const noexcept = 0;  ///< per step; the first is the steering
  /// The traits of the model for the planner.
  virtual VehicleTraits traits() const noexcept = 0;
  /// Sets the maps that rollouts look up; they must outlive their use.
  virtual void set_maps(const VehicleMaps& maps) noexcept = 0;
  /// Sets the start of the rollouts; `reference_speed` (m/s) is that of the path there.
  virtual void set_start(const VehicleStart& start, double reference_speed) noexcept = 0;
  /// Rollouts from the start over the maps.
  virtual const BatchEvaluator& evaluator() const noexcept = 0;
  /// Whether the start itself collides.
  virtual bool start_collides() const noexcept = 0;
  /// Whether the model predicts the car by its tyres and speed control. If not, the setters below have no
  /// effect, `advance` returns the start, and `command` the first steering angle with the given speed.
  virtual bool has_dynamics() const noexcept { return false; }
  /// The dynamics of a car whose tyres slip; null where they do not.
  virtual const SingleTrackDynamics* dynamics() const noexcept { return nullptr; }
  /// The car `duration` (s) after `start`, where this command acts; with a speed that is not finite it rolls.
  virtual VehicleStart advance(const VehicleStart& start, const Command& command,
                               double duration) const noexcept;
  /// The command for `period` (s) to a car at `speed` (m/s) by which the sequence begins; `inputs` as in
  /// `predict`.
  virtual Command command(std::span<const float> inputs, double speed, double period) const noexcept;
  /// The friction that predictions assume from now on.
  virtual void set_friction(double friction) noexcept;
  /// With 0, predictions from now on drive forwards. With a speed above 0 (m/s), they drive backwards, at
  /// most at this speed and against the direction of the path.
  virtual void set_reverse(double speed) noexcept;
  /// The highest speed (m/s) of predictions from now on.
  virtual void set_top_speed(double speed) noexcept;
  /// The urgency of predictions from now on.
  virtual void set_urgency(Urgency urgency) noexcept;
  /// The share (0 to 1) of the margin around the body within which predictions from now on collide.
  virtual void set_margin_share(double share) noexcept;

  /// The states (one more than steps) of one control sequence, [step][input], and its cost. A car that
  /// collides at the start must be able to leave, so the states before the first free one do not count as a
  /// collision.
  virtual PredictedCost predict(std::span<const float> inputs,
                                std::span<PredictedState> states) const noexcept = 0;
};

/// The model that `options` name, with their values; rollouts use instruction set `target`. Throws
/// std::invalid_argument on an option out of range and on an option of another model that is set.
std::unique_ptr<VehicleModel> make_vehicle_model(const VehicleOptions& options,
                                                 simd::Target target = simd::active_target());

}  // namespace slalom::vehicle
