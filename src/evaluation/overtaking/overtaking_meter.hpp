#pragma once

#include <cstddef>
#include <vector>

#include "slalom/evaluation/overtaking_record.hpp"
#include "slalom/sim/world.hpp"

namespace slalom::evaluation {

/// Watches the first car of a world among the other cars that drive.
class OvertakingMeter {
 public:
  /// Begins with the cars where they are. The track of the world has a lap path.
  explicit OvertakingMeter(const sim::World& world);

  /// To be called after each step of the world.
  void update(const sim::World& world);
  /// The figures so far; encounters that are not over are open, or with `timed_out`, not overtaken.
  OvertakingRecord record(bool timed_out) const;

 private:
  /// A car along the course.
  struct Place {
    double gap = 0;       ///< m from the first car's middle to its middle, half a course at most
    double offset = 0;    ///< m left of the course line
    double sideways = 0;  ///< m/s, to the left of the course
  };
  /// What is known of an opponent.
  struct Opponent {
    double start_gap = 0;       ///< m ahead of the first car at the start
    double touched = -1e9;      ///< s, last
    int encounter = -1;         ///< that is not over, -1 for none
    double met_gap = 0;         ///< m, whole turns between the cars when they met
    double met_progress = 0;    ///< m, of the first car
    Place before, long_before;  ///< 0 to 0.05 s ago, and 0.05 s before that
  };

  double gap(const sim::World& world, std::size_t car) const;
  Place place(const sim::World& world, std::size_t car) const;
  void meet(const sim::World& world, std::size_t car);
  void touch(const sim::World& world, std::size_t car);
  static bool causes(const Place& own, const Place& other, double wheelbase) noexcept;

  std::vector<Opponent> opponents_;
  Place own_before_, own_long_before_;
  double snapshot_ = 0;  ///< s, when `before` was
  OvertakingRecord record_;
};

}  // namespace slalom::evaluation
