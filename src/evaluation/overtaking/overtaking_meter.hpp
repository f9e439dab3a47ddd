#pragma once

#include "slalom/evaluation/overtaking_record.hpp"
#include "slalom/sim/world.hpp"

namespace slalom::evaluation {

/// s without a collision, after which the next collision is another contact.
inline constexpr double contact_pause = 0.5;

/// Watches the cars of a world, to say whose fault a collision is (OvertakingRecord has the rule).
class FaultJudge {
 public:
  /// Begins with the cars where they are. The track of the world has a lap path.
  explicit FaultJudge(const sim::World& world);

  /// To be called after each step of the world.
  void update(const sim::World& world);

  /// Whether `car`, which collides with `other` now, is at fault; else the other one is.
  bool at_fault(std::size_t car, std::size_t other) const noexcept;

 private:
  /// The position and the velocity of a car along the course.
  struct CourseState {
    double arc = 0;       ///< m
    double offset = 0;    ///< m left of the course line
    double sideways = 0;  ///< m/s, to the left of the course
  };
  static CourseState course_state(const sim::World& world, std::size_t car);

  std::vector<CourseState> before_,
      long_before_;      ///< states of each car: 0 to 0.05 s ago, and 0.05 s before that
  double snapshot_ = 0;  ///< s, when `before_` was
  double length_;        ///< m, of the course
  double wheelbase_;     ///< m
};

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
  /// The meter's state for an opponent.
  struct Opponent {
    double start_gap = 0;     ///< m ahead of the first car at the start
    double collided = -1e9;   ///< s, when the cars last collided
    int encounter = -1;       ///< index of the encounter that is not over, -1 for none
    double met_gap = 0;       ///< m, whole turns between the cars when they met
    double met_progress = 0;  ///< m, of the first car
    int side = 0;             ///< side of it on which the first car was last: 1 left, -1 right, 0 none yet
  };

  double gap(const sim::World& world, std::size_t car) const;
  void meet(const sim::World& world, std::size_t car);
  void note_side(const sim::World& world, std::size_t car, Encounter& encounter);
  void collide(const sim::World& world, std::size_t car);

  FaultJudge judge_;
  std::vector<Opponent> opponents_;
  double width_;  ///< m, of a car
  OvertakingRecord record_;
};

}  // namespace slalom::evaluation
