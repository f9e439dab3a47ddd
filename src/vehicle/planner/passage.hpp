#pragma once

#include <array>
#include <span>
#include <vector>

#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/maps/reference_path.hpp"
#include "slalom/vehicle/model/path_tracking_options.hpp"
#include "vehicle/planner/car_scale.hpp"

namespace slalom::vehicle::detail {

/// The widest way along the path, past all obstacles that the map shows.
struct WidestWay {
  double margin_share = 1;  ///< share of the body's margin that fits into its narrowest place
  double soft_share = 1;    ///< share of the soft margin that fits in addition
  double top_speed = 1e3;   ///< m/s, from which the car slows down in time to what its narrow places allow
};

/// Measures the room that obstacles leave along the path. A car that keeps a wider margin than a narrow place
/// has would rather stand than pass it.
///
/// The search covers a strip along the path. The room of a way is the least clearance on it; the widest way
/// to each place follows from those to the places before it (dynamic programming).
class Passage {
 public:
  /// Takes the path, whether it is closed, and the body of the car.
  Passage(std::span<const maps::ReferencePoint> path, bool closed, const BodyOptions& body);

  /// Searches the next `reach` m from `pose` (frame of the path); `nearest` is the point of the path nearest
  /// to it. Obstacles are those around `pose`. Ends where the map ends, and where no way is wide enough for
  /// the body: such a place is blocked, not narrow.
  WidestWay search(const maps::ClearanceMap& obstacles, const maps::Pose& pose, int nearest,
                   double reach) noexcept;

 private:
  static constexpr int sides = 30, count = 2 * sides + 1;  ///< ways to each side of the path, and all

  double soft_end() const noexcept { return radius_ + body_.margin + body_.soft_margin; }
  double passing_speed(double room) const noexcept;
  void begin(double offset) noexcept;
  double advance(const maps::ClearanceMap& obstacles, const maps::Pose& pose,
                 const maps::ReferencePoint& point) noexcept;

  std::vector<maps::ReferencePoint> path_;
  bool closed_;
  BodyOptions body_;
  CarScale scale_;
  double radius_;  ///< m, of the discs that cover the body
  std::array<double, count> rooms_{};
};

}  // namespace slalom::vehicle::detail
