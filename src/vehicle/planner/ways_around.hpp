#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slalom/core/batch_evaluator.hpp"
#include "slalom/core/sequence_batch.hpp"
#include "slalom/maps/reference_path.hpp"
#include "slalom/vehicle/model/vehicle_problem.hpp"
#include "vehicle/planner/car_scale.hpp"

namespace slalom::vehicle::detail {

/// The numbers of WaysAround.
struct WayLimits {
  CarScale car;
  double slow = 1.5 * car.speed;             ///< m/s, a top speed; the next is twice as high
  double look_ahead_time = 0.4 * car.speed;  ///< s to the point that the car steers to
};

/// Makes plans that drive beside the path, on either side of it and at several speeds, around an obstacle on
/// it. A solver samples near its last solution: if the car stands in front of an obstacle, hardly a sample
/// drives around it within the horizon.
class WaysAround {
 public:
  /// Plans have `horizon` steps of `inputs` inputs. The wheels turn as far as `steer_limit` (rad).
  WaysAround(std::span<const maps::ReferencePoint> path, bool closed, int horizon, int inputs,
             const VehicleTraits& traits, double steer_limit);

  /// Draws the ways from `start`, near the point `nearest` of the path, on ground of this friction.
  /// `path_speeds` (m/s) are those of the points of the path.
  void draw(const VehicleStart& start, int nearest, std::span<const double> path_speeds,
            double friction) noexcept;

  /// The inputs, [step][input], of the cheapest way; empty if no cost is finite.
  std::span<const float> cheapest(const BatchEvaluator& evaluator) noexcept;

 private:
  static constexpr int sides = 8;                             ///< ways on each side of the path
  static constexpr double side_step = 0.75;                   ///< car widths from one way to the next
  static constexpr int speeds = 3;                            ///< number of top speeds
  static constexpr int count = (2 * sides + 1) * speeds;      ///< number of ways
  static constexpr double turning_share = 0.6;                ///< share of the usable grip
  static constexpr double braking = 0.8, accelerating = 0.5;  ///< shares of the car's limits
  static constexpr double min_wheelbases = 2;                 ///< wheelbases that are added to the way ahead

  struct Bicycle;
  /// A point of the path, with its normal.
  struct PathNormal {
    double x, y;            ///< m
    double left_x, left_y;  ///< unit vector to the left of the path
    double gap;             ///< m, to the next point
  };

  void draw_way(int way, Bicycle car, std::span<const double> path_speeds, double grip) noexcept;
  void look_ahead(Bicycle& car) const noexcept;
  double steering_to(const Bicycle& car, double offset) const noexcept;
  bool advance(std::size_t& at) const noexcept;

  std::vector<PathNormal> path_;
  bool closed_;
  VehicleTraits traits_;
  WayLimits limits_;
  double steepest_;  ///< tangent of the wheels' angle
  SequenceBatch batch_;
  AlignedBuffer costs_;
  std::vector<std::uint8_t> collided_;
  std::vector<float> inputs_;
};

}  // namespace slalom::vehicle::detail
