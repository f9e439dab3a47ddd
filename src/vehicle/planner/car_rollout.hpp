#pragma once

#include <memory>
#include <span>

#include "slalom/core/batch_evaluator.hpp"
#include "slalom/vehicle/model/path_tracking.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::vehicle::detail {

/// The car at the start of a rollout, map frame.
struct CarStart {
  maps::Pose pose;
  double speed = 0;  ///< m/s
  double steer = 0;  ///< rad
};

/// The vehicle problem with or without its second trajectory or input, behind one face.
class CarRollout {
 public:
  static std::unique_ptr<CarRollout> make(const PathTrackingOptions& options);
  virtual ~CarRollout() = default;

  virtual void set_maps(const GridView<4>& reference, const GridView<1>& obstacles,
                        const maps::Pose& robot) noexcept = 0;
  virtual void set_start(const CarStart& start, double target_speed) noexcept = 0;
  virtual const BatchEvaluator& evaluator() const noexcept = 0;
  virtual int inputs() const noexcept = 0;
  /// Whether the start itself collides.
  virtual bool start_collides() const noexcept = 0;
  /// The states (one more than steps) of one control sequence, [step][input]. It collides if a state after
  /// the first free one does, or if none is free: a car that touches something already must be let go.
  virtual PredictedCost predict(std::span<const float> inputs,
                                std::span<PredictedState> states) const noexcept = 0;
};

}  // namespace slalom::vehicle::detail
