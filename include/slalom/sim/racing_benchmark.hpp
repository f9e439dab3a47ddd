#pragma once

#include <memory>

#include "slalom/maps/command.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/sim/gym.hpp"
#include "slalom/sim/lidar.hpp"
#include "slalom/sim/plant.hpp"
#include "slalom/sim/track.hpp"

namespace slalom::sim {

/// The centre line of a map of the racing benchmark (see RacingBenchmark), as its program uses it: an open
/// line of rows, along which progress is measured, and the periodic cubic spline through them, with its last
/// row replaced by the first, which gives start poses.
class BenchmarkLine {
 public:
  /// The rows, m. Throws std::invalid_argument on fewer than 4, equal neighbours and values not finite.
  explicit BenchmarkLine(std::vector<maps::Point> rows);

  /// m along the rows, without the gap from the last to the first.
  double length() const noexcept { return arc_.back(); }

  /// The share of the length that lies behind a point, 0..1, in steps of the rows: the arc length of the row
  /// at or before it; within the first metre the nearest of a few points of the spline decides.
  double progress(const maps::Point& point) const noexcept;

  /// Position and direction of the spline at a parameter in [0, 1], proportional to the length of the chords.
  maps::Pose pose(double parameter) const noexcept;

 private:
  maps::Point at(double parameter, maps::Point* slope) const noexcept;
  double nearest_arc(const maps::Point& point, std::size_t row) const noexcept;

  std::vector<maps::Point> rows_;
  std::vector<double> arc_;             ///< m, of the rows
  std::vector<double> parameter_;       ///< parameter of each row, 0..1
  std::vector<maps::Point> curvature_;  ///< second derivatives of the spline at the rows
};

/// The observation of a driver of the racing benchmark.
struct RacingObservation {
  double time = 0;                 ///< s since the start of the lap
  CarState state;                  ///< the true state
  std::span<const double> scan{};  ///< m, from the centre of gravity, with noise; see RacingBenchmark::lidar
  double progress = 0;             ///< share of the lap, 0..1
};

/// The world of the racing benchmark of Evans et al., "Unifying F1TENTH Autonomous Racing: Survey, Methods
/// and Benchmarks" (arXiv 2402.18558), as its program (f1tenth_benchmarks) has it where both differ:
///
///  - The car of f1tenth_gym with linear tyres, by one Euler step of 0.01 s; steering commands take effect
///    two steps later. The control period is four steps.
///  - The first lap starts at the pose (0, 0, 0), later ones at random places of the centre line, from
///    standstill. A reset makes one control period with zero commands.
///  - Once a control period, a lap ends in a collision if one of the four corners of the body is in a wall or
///    off the map. It is complete if the progress since the start is above 0.995 (and not above 0.999) after
///    more than 5 s, or after 250 s.
///  - The scan has 1080 beams over 4.7 rad. Noise and starts are those of numpy.random.default_rng(12345),
///    seeded once for a map.
class RacingBenchmark {
 public:
  static constexpr double time_step = 0.01;         ///< s, of the physics
  static constexpr int steps_per_command = 4;       ///< time steps of a control period
  static constexpr double max_time = 250;           ///< s; a lap that takes longer ends as complete
  static constexpr double collision_limit = 0.001;  ///< m, a corner this near to a wall cell collides

  /// A world for the laps on one map. The track must have no unknown cells that count as walls for the
  /// program: load its map with MapRule::grey_threshold.
  RacingBenchmark(std::shared_ptr<const Track> track, std::vector<maps::Point> centre_line);

  void reset();  ///< begins the next lap

  /// Drives one control period with the only command. If it is not finite, wheels and motor stay as they are.
  void step(std::span<const Command> commands);

  RacingObservation observation() const noexcept;       ///< the driver's present observation
  bool collided() const noexcept { return collided_; }  ///< the lap ended in a collision
  bool complete() const noexcept { return complete_; }  ///< the lap ended otherwise
  double time() const noexcept;                         ///< s since the start of the lap

  /// m/s^2, the acceleration of the centre of gravity, along and across together, in each time step.
  std::span<const double> accelerations() const noexcept { return accelerations_; }

  const LidarOptions& lidar() const noexcept { return lidar_.options(); }  ///< the scanner
  const CarParameters& car() const noexcept { return plant_.car(); }       ///< the car

 private:
  bool corner_in_wall() const noexcept;
  void look();

  std::shared_ptr<const Track> track_;
  BenchmarkLine line_;
  Plant plant_;
  Lidar lidar_;
  NumpyRandom starts_, noise_;
  std::vector<double> scan_, accelerations_;
  int lap_ = -1;
  int ticks_ = 0;
  double start_progress_ = 0, progress_ = 0;
  bool collided_ = false, complete_ = false;
};

}  // namespace slalom::sim
