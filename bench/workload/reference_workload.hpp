#pragma once

#include "bench/workload/yardstick.hpp"
#include "slalom/core/batch_evaluator.hpp"
#include "slalom/core/sequence_batch.hpp"
#include "slalom/core/simd.hpp"
#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/reference_field.hpp"
#include "slalom/vehicle/model/vehicle_model.hpp"

/// The workload `reference` for measurements of speed: the vehicle problem with the parameters of Honda et
/// al. (ICRA 2024) and 14 inputs (15 states), on a course with two parked cars. It is the same in every run.
namespace slalom::workload {

/// A closed course with straights and turns, points every 5 cm, speeds 3 to 5 m/s.
std::vector<maps::ReferencePoint> reference_course();

/// m, the ranges of a LiDAR with 1080 beams at a pose on that course: walls 1.1 m to either side of the
/// centre line, and two parked cars 2.5 and 6 m ahead of the first point.
struct ReferenceScan {
  std::vector<float> ranges;
  maps::LaserScanView view() const;
};
ReferenceScan reference_scan(const maps::Pose& robot);

/// The vehicle problem of the paper, with one trajectory per rollout.
vehicle::VehicleOptions reference_problem();

/// Maps, start and control sequences.
class ReferenceWorkload {
 public:
  static constexpr int steps = 14;

  ReferenceWorkload();

  const CarStart& start() const { return start_; }

  /// Normal samples of `steps_wanted` steps, steering in [-0.45, 0.45] rad, around a sequence that drives
  /// straight; for models with two inputs also accelerations in [-9, 9] m/s^2.
  SequenceBatch sequences(int samples, int steps_wanted = steps, int inputs = 1) const;

  Yardstick yardstick() const { return {reference_problem(), field_, cost_map_, robot_}; }

  /// The vehicle model with maps and start set, for one instruction set. It refers to the maps of this
  /// object.
  std::unique_ptr<vehicle::VehicleModel> model(const vehicle::VehicleOptions& options,
                                               simd::Target target) const;

 private:
  maps::Pose robot_;
  CarStart start_;
  maps::ReferenceField field_;
  maps::LocalCostMap cost_map_;
  maps::ClearanceMap clearance_map_;  ///< the same obstacles, for bodies that consist of discs
};

}  // namespace slalom::workload
