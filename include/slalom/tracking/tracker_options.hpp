#pragma once

#include "slalom/core/options.hpp"

namespace slalom::tracking {

/// Options of ObjectTracker. The sizes are those of a 1/10-scale racing car. Where `length` and `width` are
/// the same, objects are round: their outline gives no yaw, and they keep their velocity instead of speed and
/// turn rate.
struct TrackerOptions {
  int max_beams = 4000;           ///< of a scan; longer scans are rejected
  int max_objects = 32;           ///< that are followed at a time, with those not yet confirmed
  double max_range = 15;          ///< m, farther readings are not used
  double range_deviation = 0.02;  ///< m, standard deviation of a reading

  double wall_distance = 0.06;  ///< m, of readings to the obstacles of the map, beside 3 range deviations
  double wall_angle = 0.008;    ///< rad, times the range: added to wall_distance for errors of the yaw

  double min_incidence = 0.26;  ///< lambda, rad, of a beam on a surface that is still one cluster
  int min_points = 4;           ///< readings of a cluster that begins an object

  double length = 0.58;          ///< m, expected
  double width = 0.31;           ///< m, expected
  double size_deviation = 0.03;  ///< m, standard deviation of length and width among objects

  double max_speed = 10;                   ///< m/s
  double acceleration_deviation = 5;       ///< m/s^2, along the object
  double yaw_acceleration_deviation = 10;  ///< rad/s^2
  double gate = 3.5;  ///< standard deviations from the predicted outline to readings of an object

  /// Scans with readings of an object, before it is reported. Without a map (and with `min_speed` above 0)
  /// twice as many must show that it moves, and its speed must be at least twice its standard deviation.
  int confirming_scans = 2;
  /// Scans since its last reading that may see through the place of an object: one more drops it. An object
  /// that is not yet confirmed is dropped by the first.
  int max_misses = 3;
  /// s, after which an unseen object is dropped; a fifth of it while the object is not yet confirmed. An
  /// unseen object is also dropped once the standard deviation of its position is above 0.8 m.
  double max_unseen_time = 1.5;

  double free_margin = 0.15;  ///< m, without a map: what counts as moved into or out of free space
  double min_speed = 0.5;     ///< m/s, without a map: of an object when it is confirmed

  /// Throws std::invalid_argument naming the option, its value and the rule.
  void validate() const { validate_options(*this, "tracker"); }
};

/// Declares the options above.
template <class Options, class Visit>
requires is_options_of<Options, TrackerOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.max_beams,
        Declaration{"max_beams", "", "", "readings of a scan; longer scans are rejected", 8, 1e5});
  visit(o.max_objects, Declaration{"max_objects", "", "", "objects followed at a time", 1, 256});
  visit(o.max_range, Declaration{"max_range", "", "m", "farther readings are not used", 0.5, 1000});
  visit(o.range_deviation,
        Declaration{"range_deviation", "sigma_r", "m", "standard deviation of a reading", 1e-3, 1});
  visit(o.wall_distance,
        Declaration{
            "wall_distance", "", "m",
            "readings within this distance plus 3 range deviations of an obstacle of the map belong to it", 0,
            10});
  visit(o.wall_angle, Declaration{"wall_angle", "", "rad",
                                  "error of the yaw; times the range, it is added to wall_distance", 0, 1});
  visit(o.min_incidence, Declaration{"min_incidence", "lambda", "rad",
                                     "least angle of a beam to a surface that is one cluster", 0.01, 1.5});
  visit(o.min_points, Declaration{"min_points", "", "", "readings of a new object", 2, 1000});
  visit(o.length, Declaration{"length", "", "m", "expected length of objects", 0.01, 100});
  visit(o.width, Declaration{"width", "", "m", "expected width of objects", 0.01, 100});
  visit(o.size_deviation,
        Declaration{"size_deviation", "", "m", "standard deviation of the sizes of objects", 1e-3, 10});
  visit(o.max_speed, Declaration{"max_speed", "", "m/s", "largest speed of objects", 0.1, 100});
  visit(o.acceleration_deviation, Declaration{"acceleration_deviation", "sigma_a", "m/s^2",
                                              "standard deviation of the acceleration", 1e-3, 100});
  visit(o.yaw_acceleration_deviation, Declaration{"yaw_acceleration_deviation", "sigma_alpha", "rad/s^2",
                                                  "standard deviation of the yaw acceleration", 1e-3, 1000});
  visit(o.gate,
        Declaration{"gate", "", "", "standard deviations from the predicted outline to readings", 1, 10});
  visit(o.confirming_scans,
        Declaration{"confirming_scans", "", "", "scans with an object before it is reported", 1, 100});
  visit(o.max_misses, Declaration{"max_misses", "", "",
                                  "scans that see through an object's place before it is dropped", 0, 1000});
  visit(o.max_unseen_time,
        Declaration{"max_unseen_time", "", "s", "time out of view before an object is dropped", 0, 100});
  visit(o.free_margin, Declaration{"free_margin", "", "m",
                                   "without a map: least motion into or out of free space", 0.01, 10});
  visit(o.min_speed,
        Declaration{"min_speed", "", "m/s", "without a map: least speed of a new object", 0, 100});
}

}  // namespace slalom::tracking
