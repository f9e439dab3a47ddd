#pragma once

#include "slalom/core/options.hpp"

namespace slalom::vehicle {

/// How a model whose only input is the steering predicts the speed of the next step.
enum class SpeedModel {
  reference,  ///< the speed of the reference field at the position
  constant,   ///< the present speed
  linear,     ///< constant acceleration towards the reference speed at the start
};
inline const char* const* enum_names(SpeedModel) {
  static constexpr const char* const names[] = {"reference", "constant", "linear", nullptr};
  return names;
}

/// How the car's body is checked for collisions.
enum class BodyModel {
  discs,  ///< three discs along the body, turned with it, on a map of clearances
  box,    ///< obstacles inflated by the body in its heading at the time of the scan
};
inline const char* const* enum_names(BodyModel) {
  static constexpr const char* const names[] = {"discs", "box", nullptr};
  return names;
}

/// The car's body and the clearance that it keeps from obstacles. `visit_body` below describes the fields.
struct BodyOptions {
  BodyModel model = BodyModel::discs;
  double front = 0.461;
  double rear = 0.119;
  double width = 0.31;
  double margin = 0.04;
  double soft_margin = 0.1;
  /// With discs it falls off as the square of the clearance, with a box it is constant.
  double soft_cost = 10;
};

/// Weights of the cost of a state (see PathTracking). `visit_tracking_cost` below describes the fields.
struct TrackingCostOptions {
  double distance_weight = 1;
  double yaw_weight = 0.01;
  double terminal_distance_weight = 1;
  double terminal_yaw_weight = 0.01;
  double speed_weight = 1;
  double collision_weight = 1;
  double outside_cost = 100;
  double outside_terminal_cost = 100;
};

/// Options of the vehicle problem that all models share. `visit_options` below describes the fields.
struct PathTrackingOptions {
  double time_step = 0.05;
  double front_length = 0.15875;
  double rear_length = 0.17145;
  double steer_time_constant = 0.1;
  double dead_time = 0.025;
  SpeedModel speed = SpeedModel::reference;
  double reference_speed = 1.5;
  double max_acceleration = 5;
  double max_deceleration = 3;
  /// Only with `SpeedModel::reference`. If false, the predicted speed is at once that of the reference field.
  bool limit_acceleration = true;
  /// In the first ceil(dead_time / time_step) + 1 steps of a rollout the sequence's first input acts, and
  /// commands sent before are not known. Otherwise the planner predicts the start by the dead time, with the
  /// commands sent, and the rollout has no dead time.
  bool hold_first_input = false;
  bool localisation_less = false;
  TrackingCostOptions cost{};  ///< weights of the cost
  BodyOptions body{};          ///< dimensions of the body

  /// Wheelbase, m.
  double wheelbase() const noexcept { return front_length + rear_length; }
};

/// The options of a model that has none of its own.
struct NoOptions {
  bool operator==(const NoOptions&) const = default;
};

template <class Options, class Visit>
requires is_options_of<Options, NoOptions>
void visit_options(Options&, Visit&&) {}

namespace detail {

template <class Options, class Visit>
void visit_tracking_cost(Options& o, Visit&& visit) {
  visit(o.distance_weight, {"distance_weight", "", "weight of the squared distance to the path, 1/m^2", 0});
  visit(o.yaw_weight, {"yaw_weight", "", "weight of the squared yaw error, 1/rad^2", 0});
  visit(o.terminal_distance_weight,
        {"terminal_distance_weight", "", "distance_weight of the last state, 1/m^2", 0});
  visit(o.terminal_yaw_weight, {"terminal_yaw_weight", "", "yaw_weight of the last state, 1/rad^2", 0});
  visit(o.speed_weight, {"speed_weight", "",
                         "acceleration as an input: weight of the squared speed below the path's, s^2/m^2; "
                         "model `single_track`: of the share of a step that is lost",
                         0});
  visit(o.collision_weight,
        {"collision_weight", "", "factor of the cost map's value, which is 100 where occupied", 0});
  visit(o.outside_cost, {"outside_cost", "", "cost map value off the local map", 0});
  visit(o.outside_terminal_cost, {"outside_terminal_cost", "", "outside_cost of the last state", 0});
}

template <class Options, class Visit>
void visit_body(Options& o, Visit&& visit) {
  visit(o.model, {"body", "", "how the body is checked for collisions"});
  visit(o.front, {"body_front", "m", "reach of the body ahead of the rear axle", 0, 10});
  visit(o.rear, {"body_rear", "m", "reach of the body behind the rear axle", 0, 10});
  visit(o.width, {"body_width", "m", "width of the body", 0.01, 10});
  visit(o.margin, {"body_margin", "m", "clearance below which a state collides", 0, 1});
  visit(o.soft_margin,
        {"soft_margin", "m", "clearance beyond body_margin in which nearness has a cost", 0, 1});
  visit(o.soft_cost, {"soft_cost", "", "cost map value of a state that almost collides", 0, 100});
}

}  // namespace detail

template <class Options, class Visit>
requires is_options_of<Options, PathTrackingOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.time_step, {"time_step", "s", "step of the prediction", 1e-3, 1, "Delta tau"});
  visit(o.front_length,
        {"front_length", "m", "distance from the centre of gravity to the front axle", 1e-3, 10, "l_f"});
  visit(o.rear_length,
        {"rear_length", "m", "distance from the centre of gravity to the rear axle", 1e-3, 10, "l_r"});
  visit(o.steer_time_constant,
        {"steer_time_constant", "s", "time constant of the steering's first-order lag", 1e-3, 10, "tau"});
  visit(o.dead_time, {"dead_time", "s", "time from a command to its first effect on the steering", 0, 1});
  visit(o.speed,
        {"speed", "", "how a model whose only input is the steering predicts the speed of the next step"});
  visit(o.reference_speed, {"reference_speed", "m/s", "speed where no speed profile is used", 0, 100});
  visit(o.max_acceleration,
        {"max_acceleration", "m/s^2", "largest acceleration of the predicted speed", 0, 100});
  visit(o.max_deceleration,
        {"max_deceleration", "m/s^2", "largest deceleration of the predicted speed", 0, 100});
  visit(o.limit_acceleration,
        {"limit_acceleration", "", "the predicted speed keeps to max_acceleration and max_deceleration"});
  visit(o.hold_first_input,
        {"hold_first_input", "", "model the dead time as steps in which the sequence's first input acts"});
  visit(o.localisation_less, {"localisation_less", "", "drive by the cost map alone, without pose or path"});
  detail::visit_tracking_cost(o.cost, visit);
  detail::visit_body(o.body, visit);
}

}  // namespace slalom::vehicle
