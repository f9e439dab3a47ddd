#pragma once

#include "slalom/core/options.hpp"

namespace slalom::tracking {

/// Options of Predictor. Those of accelerations and ways are for 1/10-scale racing cars.
struct PredictorOptions {
  int max_objects = 32;               ///< that are predicted; of more, those that were tracked first
  double horizon = 1.6;               ///< s, of a prediction
  double interval = 0.1;              ///< s, from one pose to the next
  double min_speed = 0.5;             ///< m/s; what is slower stands, and is not predicted
  double braking = 4;                 ///< m/s^2, of an object that brakes
  double side_step = 0.4;             ///< m, that an object moves aside
  double reaction = 0.35;             ///< s, time constant of ways across the course
  double max_offset = 2.5;            ///< m from the course; farther objects are predicted without it
  double acceleration_deviation = 1;  ///< m/s^2, by which hypotheses are wrong along their way
  double drift_deviation = 0.1;       ///< m/s, by which they are wrong across it
  double memory = 0.3;                ///< s, after which hypotheses are compared with what the object did
  double forgetting = 0.15;  ///< share of the weights that returns to those of an unknown object, each time

  /// Throws std::invalid_argument naming the option, its value and the rule.
  void validate() const { validate_options(*this, "predictor"); }
};

/// Declares the options above.
template <class Options, class Visit>
requires is_options_of<Options, PredictorOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.max_objects, Declaration{"max_objects", "", "", "objects that are predicted", 1, 256});
  visit(o.horizon, Declaration{"horizon", "", "s", "duration of a prediction", 0.1, 20});
  visit(o.interval, Declaration{"interval", "", "s", "from one pose of a prediction to the next", 0.01, 1});
  visit(o.min_speed,
        Declaration{"min_speed", "", "m/s", "speed below which objects are not predicted", 0, 100});
  visit(o.braking, Declaration{"braking", "", "m/s^2", "deceleration of an object that brakes", 0.1, 100});
  visit(o.side_step,
        Declaration{"side_step", "", "m", "lateral distance of an object's sideways move", 0, 100});
  visit(o.reaction, Declaration{"reaction", "", "s", "time constant of ways across the course", 0.01, 10});
  visit(o.max_offset,
        Declaration{"max_offset", "", "m",
                    "distance from the course beyond which objects are predicted without it", 0, 1000});
  visit(o.acceleration_deviation,
        Declaration{"acceleration_deviation", "", "m/s^2",
                    "standard deviation of the acceleration along the motion", 0, 100});
  visit(o.drift_deviation,
        Declaration{"drift_deviation", "", "m/s", "standard deviation of the sideways drift", 0, 100});
  visit(o.memory,
        Declaration{"memory", "", "s", "time after which hypotheses are compared with the object", 0.05, 10});
  visit(o.forgetting, Declaration{"forgetting", "", "",
                                  "share of the weights that returns to those of an unknown object", 0, 1});
}

}  // namespace slalom::tracking
