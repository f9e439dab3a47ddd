#pragma once

#include "slalom/core/options.hpp"

namespace slalom::vehicle {

/// How a model whose only input is the steering predicts the speed of the next step.
enum class SpeedModel {
  reference,  ///< the speed of the reference field at the position
  constant,   ///< the present speed
  linear,     ///< constant acceleration towards the reference speed at the start
};
/// The names of the enumerators, in order.
inline const char* const* enum_names(SpeedModel) {
  static constexpr const char* const names[] = {"reference", "constant", "linear", nullptr};
  return names;
}

/// How the car's body is checked for collisions.
enum class BodyModel {
  discs,  ///< three discs along the body, turned with it, on a map of clearances
  box,    ///< obstacles inflated by the body in its heading at the time of the scan
};
/// The names of the enumerators, in order.
inline const char* const* enum_names(BodyModel) {
  static constexpr const char* const names[] = {"discs", "box", nullptr};
  return names;
}

/// The car's body and the clearance that it keeps from obstacles.
struct BodyOptions {
  BodyModel model = BodyModel::discs;  ///< how the body is checked for collisions
  double front = 0.461;                ///< m, reach ahead of the rear axle
  double rear = 0.119;                 ///< m, reach behind the rear axle
  double width = 0.31;                 ///< m
  double margin = 0.04;                ///< m, clearance below which a state collides
  double soft_margin = 0.1;            ///< m, clearance beyond `margin` in which nearness has a cost
  double soft_cost = 10;  ///< cost map value of a state that almost collides; with discs it falls off as
                          ///< the square of the clearance, with a box it is constant
};

/// Weights of the cost of a state (see PathTracking).
struct TrackingCostOptions {
  double distance_weight = 1;           ///< 1/m^2
  double yaw_weight = 0.01;             ///< 1/rad^2
  double terminal_distance_weight = 1;  ///< 1/m^2, at the last state
  double terminal_yaw_weight = 0.01;    ///< 1/rad^2, at the last state
  double speed_weight = 1;      ///< of models with acceleration: s^2/m^2; with `single_track` per lost step
  double collision_weight = 1;  ///< factor of the cost map's values; 100 is occupied
  double outside_cost = 100;    ///< cost map value off the local map
  double outside_terminal_cost = 100;  ///< cost map value off the local map, at the last state
};

/// Options of the vehicle problem that every vehicle model shares.
struct PathTrackingOptions {
  double time_step = 0.05;                   ///< s, of the prediction
  double front_length = 0.15875;             ///< m, l_f: centre of gravity to front axle
  double rear_length = 0.17145;              ///< m, l_r: centre of gravity to rear axle
  double steer_time_constant = 0.1;          ///< s, of the first-order lag of the steering
  double dead_time = 0.025;                  ///< s, from a command to its first effect on the steering
  SpeedModel speed = SpeedModel::reference;  ///< of models whose only input is the steering
  double reference_speed = 1.5;              ///< m/s, where no speed profile is used
  double max_acceleration = 5;               ///< m/s^2, of the predicted speed, >= 0
  double max_deceleration = 3;               ///< m/s^2, of the predicted speed, >= 0
  bool limit_acceleration = true;  ///< with `SpeedModel::reference`: whether the predicted speed keeps to the
                                   ///< two limits; if not, it is at once that of the reference field
  /// Models the dead time in the rollout: in its first ceil(dead_time / time_step) + 1 steps the sequence's
  /// first input acts, and commands sent before are not known. Otherwise the planner predicts the start by
  /// the dead time, with the commands sent, and the rollout has no dead time.
  bool hold_first_input = false;
  bool localisation_less = false;  ///< drive by the cost map alone, without pose or path
  TrackingCostOptions cost;        ///< weights of the cost
  BodyOptions body;                ///< dimensions of the body

  /// Wheelbase, m.
  double wheelbase() const noexcept { return front_length + rear_length; }
};

namespace detail {

template <class Options, class Visit>
void visit_tracking_cost(Options& o, Visit&& visit) {
  visit(o.distance_weight, Declaration{.name = "distance_weight",
                                       .help = "weight of the squared distance to the path, 1/m^2",
                                       .min = 0});
  visit(o.yaw_weight,
        Declaration{.name = "yaw_weight", .help = "weight of the squared yaw error, 1/rad^2", .min = 0});
  visit(o.terminal_distance_weight, Declaration{.name = "terminal_distance_weight",
                                                .help = "distance_weight of the last state, 1/m^2",
                                                .min = 0});
  visit(
      o.terminal_yaw_weight,
      Declaration{.name = "terminal_yaw_weight", .help = "yaw_weight of the last state, 1/rad^2", .min = 0});
  visit(o.speed_weight,
        Declaration{.name = "speed_weight",
                    .help = "where the acceleration is an input: weight of the squared speed below the "
                            "path's, s^2/m^2; with model `single_track`, of the share of a step that is lost",
                    .min = 0});
  visit(o.collision_weight, Declaration{.name = "collision_weight",
                                        .help = "factor of the cost map's value, which is 100 where occupied",
                                        .min = 0});
  visit(o.outside_cost,
        Declaration{.name = "outside_cost", .help = "cost map value off the local map", .min = 0});
  visit(o.outside_terminal_cost,
        Declaration{.name = "outside_terminal_cost", .help = "outside_cost of the last state", .min = 0});
}

template <class Options, class Visit>
void visit_body(Options& o, Visit&& visit) {
  visit(o.model, Declaration{.name = "body", .help = "how the body is checked for collisions"});
  visit(o.front, Declaration{.name = "body_front",
                             .unit = "m",
                             .help = "reach of the body ahead of the rear axle",
                             .min = 0,
                             .max = 10});
  visit(o.rear, Declaration{.name = "body_rear",
                            .unit = "m",
                            .help = "reach of the body behind the rear axle",
                            .min = 0,
                            .max = 10});
  visit(o.width,
        Declaration{.name = "body_width", .unit = "m", .help = "width of the body", .min = 0.01, .max = 10});
  visit(o.margin, Declaration{.name = "body_margin",
                              .unit = "m",
                              .help = "clearance below which a state collides",
                              .min = 0,
                              .max = 1});
  visit(o.soft_margin, Declaration{.name = "soft_margin",
                                   .unit = "m",
                                   .help = "clearance beyond body_margin in which nearness has a cost",
                                   .min = 0,
                                   .max = 1});
  visit(o.soft_cost, Declaration{.name = "soft_cost",
                                 .help = "cost map value of a state that almost collides",
                                 .min = 0,
                                 .max = 100});
}

}  // namespace detail

/// Declares every option by name, unit, help and range.
template <class Options, class Visit>
requires is_options_of<Options, PathTrackingOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.time_step, Declaration{.name = "time_step",
                                 .symbol = "Delta tau",
                                 .unit = "s",
                                 .help = "step of the prediction",
                                 .min = 1e-3,
                                 .max = 1});
  visit(o.front_length, Declaration{.name = "front_length",
                                    .symbol = "l_f",
                                    .unit = "m",
                                    .help = "centre of gravity to front axle",
                                    .min = 1e-3,
                                    .max = 10});
  visit(o.rear_length, Declaration{.name = "rear_length",
                                   .symbol = "l_r",
                                   .unit = "m",
                                   .help = "centre of gravity to rear axle",
                                   .min = 1e-3,
                                   .max = 10});
  visit(o.steer_time_constant, Declaration{.name = "steer_time_constant",
                                           .symbol = "tau",
                                           .unit = "s",
                                           .help = "first-order lag of the steering",
                                           .min = 1e-3,
                                           .max = 10});
  visit(o.dead_time, Declaration{.name = "dead_time",
                                 .unit = "s",
                                 .help = "from a command to its first effect on the steering",
                                 .min = 0,
                                 .max = 1});
  visit(o.speed,
        Declaration{
            .name = "speed",
            .help = "how a model whose only input is the steering predicts the speed of the next step"});
  visit(o.reference_speed, Declaration{.name = "reference_speed",
                                       .unit = "m/s",
                                       .help = "where no speed profile is used",
                                       .min = 0,
                                       .max = 100});
  visit(o.max_acceleration, Declaration{.name = "max_acceleration",
                                        .unit = "m/s^2",
                                        .help = "of the predicted speed",
                                        .min = 0,
                                        .max = 100});
  visit(o.max_deceleration, Declaration{.name = "max_deceleration",
                                        .unit = "m/s^2",
                                        .help = "of the predicted speed",
                                        .min = 0,
                                        .max = 100});
  visit(o.limit_acceleration,
        Declaration{.name = "limit_acceleration",
                    .help = "the predicted speed keeps to max_acceleration and max_deceleration"});
  visit(o.hold_first_input,
        Declaration{.name = "hold_first_input",
                    .help = "model the dead time as steps in which the sequence's first input acts"});
  visit(o.localisation_less, Declaration{.name = "localisation_less",
                                         .help = "drive by the cost map alone, without pose or path"});
  detail::visit_tracking_cost(o.cost, visit);
  detail::visit_body(o.body, visit);
}

}  // namespace slalom::vehicle
