#pragma once

#include "slalom/evaluation/tracking_record.hpp"
#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/sim/wheel_odometry.hpp"
#include "slalom/sim/world.hpp"
#include "slalom/tracking/object_tracker.hpp"
#include "slalom/vehicle/localisation/localiser.hpp"

namespace slalom::evaluation {

/// Runs a tracker on the scans of a car, and compares its objects with the other bodies of the world.
class TrackingMeter {
 public:
  /// `mode` is not off. `own` is the number of the car, `seed` that of the errors of the pose.
  TrackingMeter(TrackingMode mode, const maps::OccupancyGrid& map, const sim::World& world, std::size_t own,
                std::uint64_t seed);

  /// To be called each control step. The objects, in the map frame, until the next step; without a map, none.
  std::span<const tracking::TrackedObject> observe(const sim::World& world, const maps::LaserScanView& scan);
  /// To be called after each step of the world, of `time_step` (s).
  void moved(const sim::CarState& state, double time_step) noexcept { wheels_.update(state, time_step); }
  /// The figures so far.
  TrackingRecord record() const;

 private:
  tracking::TrackerInput locate(const sim::Observation& seen, const maps::LaserScanView& scan) noexcept;
  maps::Pose carried_on() const noexcept;
  void find_in_view(const sim::World& world, const maps::Pose& sensor);
  template <class InMap>
  void pair_up(const sim::World& world, const tracking::TrackerOutput& output, const InMap& in_map);
  void compare(const sim::World& world, const tracking::TrackerOutput& output, const maps::Pose& sensor);

  bool counts(const sim::World& world, std::size_t body) const noexcept {
    return body != own_ && (body >= world.cars() || world.on_track(body));
  }

  TrackingMode mode_;
  std::size_t own_;  ///< number of the car that scans
  sim::CarParameters car_;
  maps::Pose mount_;  ///< pose of the LiDAR from the rear axle
  sim::WheelOdometry wheels_;
  std::optional<vehicle::Localiser> localiser_;
  maps::Pose aligned_;        ///< pose of the LiDAR as the tracker aligned it last
  maps::Pose wheels_before_;  ///< pose of the odometry at that time
  bool fits_ = false;         ///< the scan fitted the map from there
  tracking::ObjectTracker tracker_;

  std::vector<float> ranges_, body_ranges_;            ///< m, without noise: of everything, and of one body
  std::vector<std::uint8_t> in_view_;                  ///< flag per body
  std::vector<double> in_view_since_;                  ///< s, per body
  std::vector<const tracking::TrackedObject*> pairs_;  ///< object of each body, null for none
  std::vector<std::uint8_t> taken_;                    ///< flag per object
  std::vector<int> false_ids_;                         ///< ascending
  TrackingRecord record_;                              ///< errors as sums of squares
};

}  // namespace slalom::evaluation
