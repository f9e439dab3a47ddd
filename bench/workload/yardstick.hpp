#pragma once

#include "slalom/core/sequence_batch.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/reference_field.hpp"
#include "slalom/vehicle/model/path_tracking_options.hpp"

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

}  // namespace slalom::workload
