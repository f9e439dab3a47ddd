#pragma once

#include "slalom/core/batch_evaluator.hpp"
#include "slalom/core/sequence_batch.hpp"
#include "slalom/core/simd.hpp"
#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/reference_field.hpp"
#include "slalom/vehicle/model/path_tracking_options.hpp"
#include "slalom/vehicle/model/vehicle_model.hpp"

/// The workload `reference` for measurements of speed: the vehicle problem with the parameters of Honda et
/// al. (ICRA 2024) and 14 inputs (15 states), on a course with two parked cars. It is the same in every run.
namespace slalom::workload {

/// The state a rollout starts from, map frame.
struct CarStart {
  double x = 0, y = 0, yaw = 0;  ///< m, m, rad
  double speed = 0;              ///< m/s
  double steer = 0;              ///< rad
};

/// The reference for all times: the vehicle problem of the paper, one trajectory per rollout, as plain scalar
/// code in double. A step calls std::tan, std::atan, cos(yaw + b), sin(yaw + b) and sin(b), wraps yaw and
/// angle difference by atan2(sin, cos), and looks up the nearest cells in separate layers. It is compiled
/// with -O2 and does not change: the clock frequency of a processor varies, but the ratio to a yardstick in
/// the same program does not.
class Yardstick {
 public:
  /// `options` are those of the vehicle problem; `robot` is the pose of the cost map's frame.
  Yardstick(const vehicle::PathTrackingOptions& options, const maps::ReferenceField& field,
            const maps::LocalCostMap& cost_map, const maps::Pose& robot);

  /// The costs of the sequences 0 ... count - 1 with one input per step.
  void evaluate(const CarStart& start, const SequenceBatch& batch, int count, double* costs) const;

 private:
  struct Layer {
    double origin_x = 0, origin_y = 0;  ///< m, the map's upper edges
    double resolution = 0;              ///< m
    int rows = 0, columns = 0;
    std::vector<float> values;  ///< [row][column]
    float outside = 0;
    double at(double x, double y) const;
  };

  double rollout(const CarStart& start, const SequenceBatch& batch, int sample) const;
  double state_cost(double x, double y, double yaw, double outside) const;

  vehicle::PathTrackingOptions options_;
  int held_steps_;
  double cos_, sin_, robot_x_, robot_y_;
  Layer distance_, yaw_, speed_, off_map_, obstacle_;
};

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

  /// The vehicle model with maps and start set, for one instruction set. It refers to this object's maps.
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
