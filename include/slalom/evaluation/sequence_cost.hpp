#pragma once

#include <memory>
#include <span>

#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/reference_path.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::evaluation {

/// The state cost of a control sequence (MS, "mean sequence cost", Honda et al., ICRA 2024, section VI) by
/// one ruler for every method and configuration: the published cost map and reference field, the published
/// weights, 15 states 0.05 s apart. For the published configuration it equals the planner's own costs.
class SequenceCostMeter {
 public:
  static constexpr int states = 15;
  static constexpr double time_step = 0.05;  ///< s

  struct Cost {
    double state = 0;
    double collision = 0;
    double total() const { return state + collision; }
  };

  /// `model` is that of the planner. Throws std::invalid_argument on a bad path.
  SequenceCostMeter(std::span<const maps::ReferencePoint> path, const vehicle::VehicleOptions& model);
  ~SequenceCostMeter();
  SequenceCostMeter(SequenceCostMeter&&) noexcept;
  SequenceCostMeter& operator=(SequenceCostMeter&&) noexcept;

  /// Makes the published maps from a scan taken with the rear axle at `robot` (map frame).
  /// `made` is the published cost map of this very scan where somebody has made it already; it must last
  /// until the next call.
  void observe(const maps::LaserScanView& scan, const maps::Pose& robot,
               const maps::LocalCostMap* made = nullptr) noexcept;

  /// Of what the planner's model predicts for the sequence it sends: interpolated to 0.05 s and cut at 15
  /// states; where it is shorter, its last input is held. Without a sequence, the present state 15 times.
  Cost planned(const vehicle::PlannerOutput& output) noexcept;

  /// Of what the published model predicts for that sequence.
  Cost published_model(const vehicle::PlannerOutput& output) noexcept;

  /// Of the state the car is in, taken 15 times: averaged over a lap, the cost of the sequence really driven.
  Cost present() const noexcept;

  /// From the car's rear axle to the path, m.
  double path_distance() const noexcept;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace slalom::evaluation
