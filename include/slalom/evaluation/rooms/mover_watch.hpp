#pragma once

#include "slalom/navigation/scan_map.hpp"
#include "slalom/tracking/object_tracker.hpp"
#include "slalom/tracking/predictor.hpp"

namespace slalom::evaluation {

/// Follows and predicts the moving objects around a robot by its scans alone, and leaves them out of the map.
class MoverWatch {
 public:
  /// For a scanner with so many beams.
  explicit MoverWatch(std::size_t beams);

  /// Takes a scan of `stamp` (s). The predictions are valid until the next one.
  std::span<const maps::PredictedObstacle> update(const navigation::RangeScan& scan, double stamp) noexcept;
  /// The scan of the last update without the readings of what is predicted. Valid until the next one.
  navigation::RangeScan without_movers() const noexcept { return {pose_, ranges_, max_range_}; }

 private:
  tracking::ObjectTracker tracker_;
  tracking::Predictor predictor_;
  std::vector<float> turned_;  ///< the ranges from behind the robot on
  std::vector<double> ranges_;
  maps::Pose pose_;       ///< pose of the last scan
  double max_range_ = 0;  ///< m, of the last scan
};

}  // namespace slalom::evaluation
