#pragma once

#include "slalom/sim/car.hpp"
#include "slalom/sim/laps.hpp"
#include "slalom/sim/pure_pursuit.hpp"
#include "slalom/sim/shapes.hpp"
#include "slalom/sim/track.hpp"

namespace slalom::sim {

/// A closed line for opponents, with speeds, that leads around parked bodies, and the room beside it.
///
/// The given path is resampled at about 0.2 m. Of the offsets from it at which a car has its margins (0.1 m
/// from walls to a circle around the body's middle, as wide as the body; 0.12 m to parked bodies), dynamic
/// programming takes the way round that stays nearest to the path and moves least from side to side, by at
/// most 0.25 m for each metre. If there is none, it is searched with smaller margins. If there is none
/// without margins either, the line is the path. Speeds are those of the path, lowered to the limits of the
/// accelerations, 6 m/s^2 across and 5 m/s^2 along, on the way that was found. All for 1/10-scale cars.
class RacingLine {
 public:
  /// The line at an arc length of the path.
  struct Point {
    maps::Point point;  ///< m, of the path, map frame
    double yaw = 0;     ///< rad, direction of the path
    double speed = 0;   ///< m/s
    double offset = 0;  ///< m left of the path, of the line
    double least = 0;   ///< m left of the path, the least offset at which a car has its margins
    double most = 0;    ///< m left of the path, the largest

    /// The place beside `point`, `left` (m) to the left of the path.
    maps::Point beside(double left) const noexcept;
  };

  /// Along a closed path with the speeds to drive, for cars of this size, among bodies that do not move.
  /// Throws std::invalid_argument on fewer than 3 points, values not finite, and a path without length.
  RacingLine(std::span<const PathPoint> path, const Track& track, const CarParameters& car,
             std::span<const Box> parked = {});

  const LapPath& path() const noexcept { return path_; }  ///< the path, along which arc lengths count
  /// The line at an arc length (m, any number of turns), linear between samples.
  Point at(double arc) const noexcept;
  /// m from arc length `from` to `to` along the path, in [-length / 2, length / 2).
  double between(double from, double to) const noexcept;

 private:
  std::vector<std::uint8_t> free_cells(const Track& track, const CarParameters& car,
                                       std::span<const Box> parked, double wall_margin,
                                       double parked_margin) const;
  bool find_way(std::span<const std::uint8_t> free);
  void find_room(std::span<const std::uint8_t> free);
  void smooth();
  void limit_speeds();

  LapPath path_;
  std::vector<Point> points_;
  double spacing_ = 0;  ///< m
};

}  // namespace slalom::sim
