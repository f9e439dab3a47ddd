#pragma once

#include "slalom/core/options.hpp"

namespace slalom::tracking {

/// Options of Predictor. Those of accelerations and ways are for 1/10-scale racing cars.
/// `visit_options` below describes the fields.
struct PredictorOptions {
  int max_objects = 32;
  double horizon = 1.6;
  double interval = 0.1;
  double min_speed = 0.5;
  double braking = 4;
  double side_step = 0.4;
  double reaction = 0.35;
  double max_offset = 2.5;
  double acceleration_deviation = 1;
  double drift_deviation = 0.1;
  double memory = 0.3;
  double forgetting = 0.15;
};

template <class Options, class Visit>
requires is_options_of<Options, PredictorOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.max_objects, {"max_objects", "", "objects that are predicted: those tracked longest", 1, 256});
  visit(o.horizon, {"horizon", "s", "duration of a prediction", 0.1, 20});
  visit(o.interval, {"interval", "s", "time from one pose of a prediction to the next", 0.01, 1});
  visit(o.min_speed, {"min_speed", "m/s", "speed below which objects are not predicted", 0, 100});
  visit(o.braking, {"braking", "m/s^2", "deceleration of an object that brakes", 0.1, 100});
  visit(o.side_step, {"side_step", "m", "lateral distance of an object's sideways move", 0, 100});
  visit(o.reaction, {"reaction", "s", "time constant of ways across the course", 0.01, 10});
  visit(o.max_offset, {"max_offset", "m",
                       "distance from the course beyond which objects are predicted without it", 0, 1000});
  visit(o.acceleration_deviation, {"acceleration_deviation", "m/s^2",
                                   "standard deviation of the acceleration along the motion", 0, 100});
  visit(o.drift_deviation, {"drift_deviation", "m/s", "standard deviation of the sideways drift", 0, 100});
  visit(o.memory, {"memory", "s", "time after which hypotheses are compared with the object", 0.05, 10});
  visit(o.forgetting, {"forgetting", "",
                       "share of the weights that returns, each time, to those of an unknown object", 0, 1});
}

}  // namespace slalom::tracking
