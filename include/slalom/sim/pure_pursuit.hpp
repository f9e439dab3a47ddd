#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "slalom/maps/command.hpp"
#include "slalom/maps/pose.hpp"

namespace slalom::sim {

/// A point of a closed path to follow and the speed wanted there.
struct PathPoint {
  maps::Point point;  ///< m, map frame
  double speed = 0;   ///< m/s
};

/// Options of PurePursuit.
struct PurePursuitOptions {
  double lookahead = 1.0;  ///< m, distance of the point that is aimed at
  /// As f1tenth_gym: the nearest point is searched on an open path and the target on a closed one, whose
  /// segments are shifted by 1e-6 m at their ends. The target is the start of the segment found. The steering
  /// is that for an arc with the fixed lookahead as its chord, and is not bounded.
  bool gym = false;
};

/// An opponent that follows a path: R. C. Coulter, "Implementation of the Pure Pursuit Path Tracking
/// Algorithm", CMU-RI-TR-92-01 (1992): the arc that leads from the car through a point of the path at
/// lookahead distance, tan(steer) = wheelbase 2 y / lookahead^2 with y sideways in the car's frame. If the
/// path is farther away, but nearer than 10 m, it aims at the first point of the nearest segment; else it is
/// lost and drives straight ahead at 0.5 m/s.
class PurePursuit {
 public:
  /// Throws std::invalid_argument on fewer than 3 points, values not finite, and a lookahead not above 0.
  PurePursuit(std::vector<PathPoint> path, const PurePursuitOptions& options = {});

  /// The nearest position on the path.
  struct Nearest {
    std::size_t segment = 0;  ///< from this row to the next
    double along = 0;         ///< place along the segment, [0, 1]
    double distance = 0;      ///< m
  };
  /// The point to steer for.
  struct Target {
    /// How it was found.
    enum class Mode { lookahead, reacquire, lost };
    Mode mode = Mode::lost;  ///< how it was found
    int row = -2;            ///< start of the segment found (-1 the last row); -2 if lost
    double along = -1;       ///< place along that segment, [0, 1]; -1 where it was not searched
    Nearest nearest;         ///< position of the car on the path
    PathPoint aim;           ///< point to aim at, and its speed
  };

  Nearest nearest(const maps::Point& position) const noexcept;  ///< the nearest position on the path
  Target target(const maps::Point& position) const noexcept;    ///< the point to steer for from a position

  Command command(const maps::Pose& pose) const noexcept;  ///< steering and speed for a car at `pose`

 private:
  struct Crossing {
    int row;
    double along;
  };
  std::optional<Crossing> cross_circle(const maps::Point& middle, std::size_t start,
                                       double along) const noexcept;
  std::optional<double> cross_segment(const maps::Point& middle, int row, double least) const noexcept;

  std::vector<PathPoint> path_;
  PurePursuitOptions options_;
};

}  // namespace slalom::sim
