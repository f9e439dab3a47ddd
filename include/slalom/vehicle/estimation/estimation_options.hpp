#pragma once

#include "slalom/core/options.hpp"

namespace slalom::vehicle {

/// Noise of measurements and predictions, as the observer of the state assumes it: standard deviations.
struct ObserverOptions {
  double position_noise = 0.005;      ///< m, of a position, at least
  double heading_noise = 0.003;       ///< rad, of a heading, at least
  double speed_noise = 0.1;           ///< m/s, of a speed
  double gyro_noise = 0.01;           ///< rad/s, of the mean over a control period
  double accelerometer_noise = 0.5;   ///< m/s^2, of the mean over a control period, with the bias
  double acceleration_noise = 5;      ///< m/s^2, of the model, along the car
  double sideways_noise = 2;          ///< m/s^2, of the model, across the car
  double yaw_acceleration_noise = 8;  ///< rad/s^2, of the model
};

/// Declares every option by name, unit, help and range.
template <class Options, class Visit>
requires is_options_of<Options, ObserverOptions>
void visit_options(Options& o, Visit&& visit) {
  const auto number = [&](auto& field, const char* name, const char* unit, const char* help) {
    visit(field, Declaration{.name = name, .unit = unit, .help = help, .min = 1e-6, .max = 1e3});
  };
  number(o.position_noise, "position_noise", "m", "state observer: of a position, at least");
  number(o.heading_noise, "heading_noise", "rad", "state observer: of a heading, at least");
  number(o.speed_noise, "speed_noise", "m/s", "state observer: of a speed");
  number(o.gyro_noise, "gyro_noise", "rad/s", "state observer: of the mean over a control period");
  number(o.accelerometer_noise, "accelerometer_noise", "m/s^2",
         "state observer: of the mean over a control period, with the bias");
  number(o.acceleration_noise, "acceleration_noise", "m/s^2", "state observer: of the model, along the car");
  number(o.sideways_noise, "sideways_noise", "m/s^2", "state observer: of the model, across the car");
  number(o.yaw_acceleration_noise, "yaw_acceleration_noise", "rad/s^2", "state observer: of the model");
}

/// Options of the estimates of state and car that are made while driving, for models with slipping tyres.
struct EstimationOptions {
  bool identify = true;            ///< learn friction, steering gain and delay; else the given values hold
  double friction_quantile = 0.2;  ///< of the friction's distribution, on which plans rely
  double friction_spread = 0.5;    ///< standard deviation of the logarithm of the friction, in advance
  double gain_spread = 0.05;       ///< standard deviation of the steering gain around 1, in advance
  double delay_spread = 0.06;      ///< s, standard deviation of the delay, in advance
  double memory = 2.0;             ///< s of turning after which what was learned is forgotten
  double window = 0.4;             ///< s of driving that each hypothesis predicts; at most 40 control periods
  double lateral_noise = 0.02;     ///< m, deviation of a predicted position, sideways
  double yaw_noise = 0.02;         ///< rad, deviation of a predicted heading
  ObserverOptions observer;        ///< of the state
};

/// Declares every option by name, unit, help and range.
template <class Options, class Visit>
requires is_options_of<Options, EstimationOptions>
void visit_options(Options& o, Visit&& visit) {
  const auto number = [&](auto& field, const char* name, const char* unit, const char* help, double min,
                          double max) {
    visit(field, Declaration{.name = name, .unit = unit, .help = help, .min = min, .max = max});
  };
  visit(o.identify, Declaration{.name = "identify",
                                .help = "learn friction, steering gain and delay while driving, with a model "
                                        "whose tyres slip; else the given values hold"});
  number(o.friction_quantile, "friction_quantile", "",
         "quantile of the friction's distribution on which plans rely", 0.01, 0.99);
  number(o.friction_spread, "friction_spread", "",
         "standard deviation of the logarithm of the friction, in advance", 0.01, 2);
  number(o.gain_spread, "gain_spread", "", "standard deviation of the steering gain, in advance", 0.001, 1);
  number(o.delay_spread, "delay_spread", "s", "standard deviation of the delay, in advance", 0.001, 1);
  number(o.memory, "identification_memory", "s", "of turning, after which what was learned is forgotten", 0.1,
         100);
  number(o.window, "identification_window", "s", "of driving that each hypothesis predicts", 0.1, 0.8);
  number(o.lateral_noise, "lateral_noise", "m", "deviation of a predicted position, sideways", 1e-3, 1);
  number(o.yaw_noise, "yaw_noise", "rad", "deviation of a predicted heading", 1e-3, 1);
  visit_options(o.observer, visit);
}

}  // namespace slalom::vehicle
