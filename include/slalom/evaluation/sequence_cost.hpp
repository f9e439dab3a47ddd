#pragma once

#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/reference_path.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::evaluation {

/// The cost of a control sequence in states and collisions (its mean over a lap is the MS, "mean sequence
/// cost", Honda et al., ICRA 2024, section V-A), computed in the same way for every method and configuration:
/// cost map, reference field and weights of the paper's program, 15 states 0.05 s apart. For the
/// configuration `published` it equals the planner's own costs.
class SequenceCostMeter {
 public:
  static constexpr int states = 15;          ///< states that a cost is summed over
  static constexpr double time_step = 0.05;  ///< s

  /// A cost and its two terms.
  struct Cost {
    double state = 0;      ///< cost of the distance to the path and the yaw error
    double collision = 0;  ///< cost of walls and obstacles
    /// Their sum.
    double total() const { return state + collision; }
  };

  /// `model` has the options of the planner's vehicle model, which predicts states in `planned`. Throws
  /// std::invalid_argument if the path or an option is invalid.
  SequenceCostMeter(std::span<const maps::ReferencePoint> path, const vehicle::VehicleOptions& model);
  ~SequenceCostMeter();
  /// Makes a meter like the other one; it must observe before it measures.
  SequenceCostMeter(const SequenceCostMeter& other);
  /// Copies likewise.
  SequenceCostMeter& operator=(const SequenceCostMeter& other);
  /// Moves the meter; the source can only be destroyed or assigned to.
  SequenceCostMeter(SequenceCostMeter&&) noexcept;
  /// Moves likewise.
  SequenceCostMeter& operator=(SequenceCostMeter&&) noexcept;

  /// Computes the maps from a scan taken with the rear axle at `robot` (map frame). If the caller has a cost
  /// map of this scan with the options of the paper's program, it can pass it as `made`. `scan` is then not
  /// used, and `made` must stay valid until the next call.
  void observe(const maps::LaserScanView& scan, const maps::Pose& robot,
               const maps::LocalCostMap* made = nullptr) noexcept;

  /// The cost of the states that the planner's model predicts for its control sequence, interpolated to 0.05
  /// s and cut at 15 states; a shorter sequence is extended by its last input. Without a sequence: present().
  /// Only after `observe`.
  Cost planned(const vehicle::PlannerOutput& output) noexcept;

  /// 15 times the stage cost of the pose given to `observe`. Its mean over a lap is the cost of the driven
  /// trajectory. Only after `observe`.
  Cost present() const noexcept;

  /// m, from the cell of the reference field with the rear axle to the nearest point of the path.
  double path_distance() const noexcept;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace slalom::evaluation
