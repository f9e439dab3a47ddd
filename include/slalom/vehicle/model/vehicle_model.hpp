#pragma once

#include "slalom/core/batch_evaluator.hpp"
#include "slalom/core/instruction_set.hpp"
#include "slalom/maps/command.hpp"
#include "slalom/vehicle/model/single_track_dynamics.hpp"
#include "slalom/vehicle/model/vehicle_options.hpp"
#include "slalom/vehicle/model/vehicle_problem.hpp"

namespace slalom::vehicle {

/// A vehicle problem of any type, as the planner uses it. A copy continues bit for bit like the original.
class VehicleModel {
 public:
  virtual ~VehicleModel() = default;

  /// Copies the model; the copy looks up the same maps.
  virtual std::unique_ptr<VehicleModel> clone() const = 0;
  virtual int inputs() const noexcept = 0;  ///< per step; the first is the steering
  /// The properties of the model.
  virtual VehicleTraits traits() const noexcept = 0;
  /// Sets the maps that rollouts look up; they must outlive their use.
  virtual void set_maps(const VehicleMaps& maps) noexcept = 0;
  /// Sets the start of rollouts. `reference_speed` (m/s) is the speed of the path there.
  virtual void set_start(const VehicleStart& start, double reference_speed) noexcept = 0;
  /// Rollouts from the start over the maps.
  virtual const BatchEvaluator& evaluator() const noexcept = 0;
  /// Whether the start itself collides.
  virtual bool start_collides() const noexcept = 0;
  /// Writes the states (one more than steps) of one control sequence, [step][input], and returns its cost. A
  /// car that collides at the start must be able to leave, so the states before the first free one do not
  /// count as a collision.
  virtual PredictedCost predict(std::span<const float> inputs,
                                std::span<PredictedState> states) const noexcept = 0;
};

/// The model of a car whose tyres slip. It predicts the car by its tyres and speed control.
class DynamicVehicleModel : public VehicleModel {
 public:
  /// The equations of motion.
  virtual const SingleTrackDynamics& dynamics() const noexcept = 0;
  /// Sets the conditions of predictions from the next `set_start` on. Before the first call, the friction is
  /// that of the options and all other conditions have their defaults.
  virtual void set_conditions(const DrivingConditions& conditions) noexcept = 0;
  /// Predicts the car `duration` (s) after `start` under this command, on ground of this friction. If the
  /// speed of the command is not finite, the car rolls.
  virtual VehicleStart advance(const VehicleStart& start, const Command& command, double duration,
                               double friction) const noexcept = 0;
  /// Returns the command that begins the sequence [step][input], for `period` (s) and a car at `speed` (m/s).
  virtual Command command(std::span<const float> inputs, double speed, double period) const noexcept = 0;
};

/// Makes the model that `options` name; rollouts use the instruction set `target`. It is a
/// DynamicVehicleModel if tyres slip (`traits().tyres.friction` above 0). Throws std::invalid_argument if an
/// option is out of range or if an option of another model is set.
std::unique_ptr<VehicleModel> make_vehicle_model(const VehicleOptions& options,
                                                 simd::Target target = simd::active_target());

}  // namespace slalom::vehicle
