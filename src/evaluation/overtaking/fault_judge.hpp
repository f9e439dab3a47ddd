#pragma once

#include "slalom/sim/world.hpp"

namespace slalom::evaluation {

/// s without a collision, after which the next collision is another contact.
inline constexpr double contact_pause = 0.5;

/// Watches the cars of a world, to say who is at fault where two of them collide (OvertakingRecord has the
/// rule).
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

}  // namespace slalom::evaluation
