#pragma once

#include "slalom/core/options.hpp"

namespace slalom::vehicle {

/// Noise of measurements and predictions, as the observer of the state assumes it: standard deviations.
/// `visit_options` below describes the fields.
struct ObserverOptions {
  double position_noise = 0.005;
  double heading_noise = 0.003;
  double speed_noise = 0.1;
  double gyro_noise = 0.01;
  double accelerometer_noise = 0.5;
  double acceleration_noise = 5;
  double sideways_noise = 2;
  double yaw_acceleration_noise = 8;
};

template <class Options, class Visit>
requires is_options_of<Options, ObserverOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.position_noise,
        {"position_noise", "m", "state observer: least standard deviation of a position", 1e-6, 1e3});
  visit(o.heading_noise,
        {"heading_noise", "rad", "state observer: least standard deviation of a heading", 1e-6, 1e3});
  visit(o.speed_noise, {"speed_noise", "m/s", "state observer: standard deviation of a speed", 1e-6, 1e3});
  visit(o.gyro_noise,
        {"gyro_noise", "rad/s", "state observer: standard deviation of the gyro's mean over a control period",
         1e-6, 1e3});
  visit(
      o.accelerometer_noise,
      {"accelerometer_noise", "m/s^2",
       "state observer: standard deviation of the accelerometer's mean over a control period, with its bias",
       1e-6, 1e3});
  visit(o.acceleration_noise,
        {"acceleration_noise", "m/s^2",
         "state observer: standard deviation of the model's acceleration along the car", 1e-6, 1e3});
  visit(o.sideways_noise,
        {"sideways_noise", "m/s^2",
         "state observer: standard deviation of the model's acceleration across the car", 1e-6, 1e3});
  visit(o.yaw_acceleration_noise,
        {"yaw_acceleration_noise", "rad/s^2",
         "state observer: standard deviation of the model's yaw acceleration", 1e-6, 1e3});
}

/// Options of the estimates of state and car that are made while driving, for models with slipping tyres.
/// `visit_options` below describes the fields.
struct EstimationOptions {
  bool identify = true;
  double friction_quantile = 0.2;
  double friction_spread = 0.5;
  double gain_spread = 0.05;
  double delay_spread = 0.06;
  double memory = 2.0;
  double window = 0.4;
  double lateral_noise = 0.02;
  double yaw_noise = 0.02;
  ObserverOptions observer;  ///< options of the state observer
};

template <class Options, class Visit>
requires is_options_of<Options, EstimationOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.identify, {"identify", "",
                     "learn friction, steering gain and delay while driving on tyres that slip; else the "
                     "given values hold"});
  visit(o.friction_quantile,
        {"friction_quantile", "", "quantile of the friction's distribution on which plans rely", 0.01, 0.99});
  visit(o.friction_spread,
        {"friction_spread", "", "standard deviation of the logarithm of the friction, in advance", 0.01, 2});
  visit(o.gain_spread,
        {"gain_spread", "", "standard deviation of the steering gain around 1, in advance", 0.001, 1});
  visit(o.delay_spread, {"delay_spread", "s", "standard deviation of the delay, in advance", 0.001, 1});
  visit(o.memory, {"identification_memory", "s", "time of turning after which what was learned is forgotten",
                   0.1, 100});
  visit(o.window, {"identification_window", "s",
                   "time of driving that each hypothesis predicts; at most 40 control periods", 0.1, 0.8});
  visit(o.lateral_noise, {"lateral_noise", "m", "deviation of a predicted position, sideways", 1e-3, 1});
  visit(o.yaw_noise, {"yaw_noise", "rad", "deviation of a predicted heading", 1e-3, 1});
  visit_options(o.observer, visit);
}

}  // namespace slalom::vehicle
