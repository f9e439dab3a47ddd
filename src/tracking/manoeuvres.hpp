#pragma once

#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/tracking/object_tracker.hpp"
#include "slalom/tracking/predictor_options.hpp"
#include "tracking/course_line.hpp"

namespace slalom::tracking {

/// A manoeuvre of an object. The first two are also those of an object without a course; the last one is
/// possible only where a car came by before.
enum class Manoeuvre { keep, brake, follow, left, right, repeat };
inline constexpr std::size_t manoeuvres_without_course = 2;  ///< the first ones
/// Weights of the manoeuvres before an object is known. They are divided by their sum.
inline constexpr std::array usual_weights{0.4, 0.08, 0.36, 0.08, 0.08, 0.4};
inline constexpr std::size_t manoeuvres = usual_weights.size();

/// The motion of an object from which hypotheses are drawn.
struct Motion {
  bool on_course = false;
  maps::Pose pose;        ///< pose of the middle
  double speed = 0;       ///< m/s; on a course along it
  double yaw_rate = 0;    ///< rad/s, without a course
  double arc = 0;         ///< m, on a course
  double offset = 0;      ///< m, on a course
  double drift = 0;       ///< m/s, by which the offset grows
  double rise = 0;        ///< 1/s, by which the ratio of the speed to the course's rises while it is below 1
  Habits::Habit habit{};  ///< habit of the cars that came by here, on a course
};

/// The motion of an object: on the course if there is one and it drives along it.
Motion motion_of(const TrackedObject& object, const CourseLine& course,
                 const PredictorOptions& options) noexcept;

/// An object on its way through a hypothesis.
class Way {
 public:
  Way(const Motion& motion, Manoeuvre manoeuvre, const CourseLine& course, const Habits& habits,
      const PredictorOptions& options)
      : start_(motion),
        now_(motion),
        manoeuvre_(manoeuvre),
        course_(course),
        habits_(habits),
        options_(options) {}
  void advance(double duration) noexcept;  ///< goes on for `duration` (s)
  const Motion& now() const noexcept { return now_; }
  maps::Pose pose() const noexcept;

 private:
  void advance_on_course(double duration) noexcept;
  void repeat(double duration) noexcept;

  Motion start_, now_;
  Manoeuvre manoeuvre_;
  const CourseLine& course_;
  const Habits& habits_;
  const PredictorOptions& options_;
  double time_ = 0;
};

}  // namespace slalom::tracking
