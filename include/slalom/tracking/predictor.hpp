#pragma once

#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/maps/reference_path.hpp"
#include "slalom/tracking/object_tracker.hpp"
#include "slalom/tracking/predictor_options.hpp"

/// Predicts the motion of tracked objects, in hypotheses with weights:
///
///     Predictor predictor(path);
///     while (driving) {
///       const TrackerOutput& seen = tracker.update({scan, sensor_pose, stamp});
///       const auto others = predictor.update(seen.objects, stamp);
///       planner.update({.scan = scan, .odometry = odometry, .others = others});
///     }
///
/// Along a course an object with offset d from it and speed v
///  1. keeps its offset,
///  2. follows the course: d goes to 0,
///  3. brakes,
///  4. moves to the left or 5. to the right of where it is,
///  6. does what the last car did that came by here, on a closed course,
/// and but for the third and sixth keeps the ratio of its speed to that of the course. Without a course, far
/// from it or across it, an object keeps its turn rate and speed, or brakes.
///
/// Weights are probabilities. Every `memory` seconds each hypothesis of that time ago is compared with what
/// the object has done since: w_h <- (1 - f) w_h L_h / sum + f p_h, with L_h the normal density of its error
/// in arc length, offset and speed, f the `forgetting` and p_h the weights of an unknown object (the steps of
/// a filter for a hidden Markov chain, in which an object changes its mind with probability f). An object
/// that was not compared for more than 10 s, or whose stamps go back, is unknown again. The four heaviest
/// hypotheses are returned. Deviations grow from those of the track.
namespace slalom::tracking {

/// A predictor. After construction nothing allocates or throws.
class Predictor {
 public:
  /// Predicts without a course. Throws std::invalid_argument on options out of range.
  explicit Predictor(const PredictorOptions& options = {});
  /// Predicts along a course, which is closed if its ends are about as near as its points. Throws
  /// std::invalid_argument on options out of range and where check_reference_path does.
  explicit Predictor(std::span<const maps::ReferencePoint> course, const PredictorOptions& options = {});
  ~Predictor();
  /// Copies the memory of objects; the predictions of the last update are the source's alone.
  Predictor(const Predictor& other);
  Predictor& operator=(const Predictor& other);
  Predictor(Predictor&&) noexcept;  ///< moves; the source can only be destroyed or assigned to
  Predictor& operator=(Predictor&&) noexcept;

  /// Predictions of the objects that move, as they are at `stamp` (s), in their frame, which is that of the
  /// course. An object moves if its speed is at least `min_speed` and above three of its standard deviations.
  /// Objects beyond the first `max_objects` are left out, and so are objects with numbers that are
  /// not finite or absurdly large. Valid until the next call.
  std::span<const maps::PredictedObstacle> update(std::span<const TrackedObject> objects,
                                                  double stamp) noexcept;
  void reset() noexcept;  ///< forgets all objects

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace slalom::tracking
