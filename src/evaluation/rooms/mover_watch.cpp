#include "slalom/evaluation/rooms/mover_watch.hpp"

#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/tracking/people.hpp"

namespace slalom::evaluation {

namespace {

constexpr double readings_margin = 0.15;  // m, between the readings of somebody and the box

}  // namespace

// Without a map: pallets, which the map does not show either, are then no objects.
MoverWatch::MoverWatch(std::size_t beams)
    : tracker_(tracking::people_tracker_options()),
      predictor_(tracking::people_predictor_options()),
      turned_(beams),
      ranges_(beams) {}

std::span<const maps::PredictedObstacle> MoverWatch::update(const navigation::RangeScan& scan,
                                                            double stamp) noexcept {
  pose_ = scan.pose;
  max_range_ = scan.max_range;
  // The tracker sees no objects across the ends of a scan, so these are behind the robot.
  const std::size_t count = turned_.size(), half = count / 2;
  for (std::size_t i = 0; i < count; ++i)
    turned_[i] = static_cast<float>(scan.ranges[(i + count - half) % count]);
  const double increment = 2 * std::numbers::pi / static_cast<double>(count);
  const maps::LaserScanView view{turned_, -increment * static_cast<double>(half), increment, 0.02,
                                 scan.max_range};
  const tracking::TrackerOutput& seen = tracker_.update({.scan = view, .sensor = scan.pose, .stamp = stamp});
  const std::span<const maps::PredictedObstacle> predicted = predictor_.update(seen.objects, stamp);
  for (const maps::PredictedObstacle& each : predicted)
    maps::drop_readings_of(each, readings_margin, scan.pose, view, turned_);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t from = (i + half) % count;
    ranges_[i] = std::isnan(turned_[from]) ? static_cast<double>(turned_[from]) : scan.ranges[i];
  }
  return predicted;
}

}  // namespace slalom::evaluation
