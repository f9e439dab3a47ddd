#pragma once

#include "slalom/core/options.hpp"

namespace slalom::tracking {

/// Options of ObjectTracker. The sizes are those of a 1/10-scale racing car. Where `length` and `width` are
/// the same, objects are round: their outline gives no yaw, and they keep their velocity instead of speed and
/// turn rate. `visit_options` below describes the fields.
struct TrackerOptions {
  int max_beams = 4000;
  int max_objects = 32;
  double max_range = 15;
  double range_deviation = 0.02;

  double wall_distance = 0.06;
  double wall_angle = 0.008;

  double min_incidence = 0.26;
  int min_points = 4;

  double length = 0.58;
  double width = 0.31;
  double size_deviation = 0.03;

  double max_speed = 10;
  double acceleration_deviation = 5;
  double yaw_acceleration_deviation = 10;
  double gate = 3.5;

  /// Without a map (and with `min_speed` above 0) twice as many scans must show that the object moves, and
  /// its speed must be at least twice its standard deviation.
  int confirming_scans = 2;
  int max_misses = 3;  ///< An object that is not yet confirmed is dropped by the first.
  /// A fifth of it while the object is not yet confirmed. An unseen object is also dropped once the standard
  /// deviation of its position is above 0.8 m.
  double max_unseen_time = 1.5;

  double free_margin = 0.15;
  double min_speed = 0.5;
};

template <class Options, class Visit>
requires is_options_of<Options, TrackerOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.max_beams, {"max_beams", "", "readings of a scan; longer scans are rejected", 8, 1e5});
  visit(o.max_objects, {"max_objects", "", "objects at a time, with those not yet confirmed", 1, 256});
  visit(o.max_range, {"max_range", "m", "farther readings are not used", 0.5, 1000});
  visit(o.range_deviation, {"range_deviation", "m", "standard deviation of a reading", 1e-3, 1, "sigma_r"});
  visit(o.wall_distance,
        {"wall_distance", "m",
         "readings within this distance plus 3 range deviations of an obstacle of the map belong to it", 0,
         10});
  visit(o.wall_angle,
        {"wall_angle", "rad", "error of the yaw; times the range, adds to wall_distance", 0, 1});
  visit(o.min_incidence, {"min_incidence", "rad", "least angle of a beam to a surface that is one cluster",
                          0.01, 1.5, "lambda"});
  visit(o.min_points, {"min_points", "", "readings of a new object", 2, 1000});
  visit(o.length, {"length", "m", "expected length of objects", 0.01, 100});
  visit(o.width, {"width", "m", "expected width of objects", 0.01, 100});
  visit(o.size_deviation, {"size_deviation", "m", "standard deviation of the sizes of objects", 1e-3, 10});
  visit(o.max_speed, {"max_speed", "m/s", "largest speed of objects", 0.1, 100});
  visit(o.acceleration_deviation,
        {"acceleration_deviation", "m/s^2", "standard deviation of the acceleration", 1e-3, 100, "sigma_a"});
  visit(o.yaw_acceleration_deviation,
        {"yaw_acceleration_deviation", "rad/s^2", "standard deviation of the yaw acceleration", 1e-3, 1000,
         "sigma_alpha"});
  visit(o.gate, {"gate", "", "standard deviations from the predicted outline to readings", 1, 10});
  visit(o.confirming_scans, {"confirming_scans", "", "scans with an object before it is reported", 1, 100});
  visit(o.max_misses,
        {"max_misses", "", "scans that may see through an object before it is dropped", 0, 1000});
  visit(o.max_unseen_time, {"max_unseen_time", "s", "time out of view before an object is dropped", 0, 100});
  visit(o.free_margin, {"free_margin", "m", "without a map: least motion in or out of free space", 0.01, 10});
  visit(o.min_speed, {"min_speed", "m/s", "without a map: least speed of an object to confirm", 0, 100});
}

}  // namespace slalom::tracking
