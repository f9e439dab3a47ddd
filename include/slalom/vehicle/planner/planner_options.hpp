#pragma once

#include "slalom/core/options.hpp"

namespace slalom::vehicle {

namespace published {

/// Parts of the planner that follow the published program of Honda et al. (ICRA 2024).
struct PlannerOptions {
  bool maps = false;  ///< cost map and reference field as in the paper's program
  /// Subtract whole turns from the planned steering angle, and limit only the command to `steer_limit`: the
  /// observer follows the angle itself. It matters where a method leaves its bounds (`clamp_solution`). The
  /// paper's program sends the angle without a limit; its simulator stops the wheels at 0.4189 rad.
  bool wrap_steer = false;
};

}  // namespace published

/// Options of the estimates of state, car and ground that are made while driving, for models whose tyres
/// slip. `visit_options` below describes the fields.
struct EstimationOptions {
  bool identify = true;
  double friction_quantile = 0.2;
  double lateral_noise = 0.02;
  double position_noise = 0.005;
  double heading_noise = 0.003;
};

template <class Options, class Visit>
requires is_options_of<Options, EstimationOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.identify, {"identify", "",
                     "learn friction, steering gain and delay while driving on tyres that slip; else the "
                     "given values hold"});
  visit(o.friction_quantile,
        {"friction_quantile", "",
         "quantile of the friction's distribution on which plans rely once it is known", 0.01, 0.99});
  visit(o.lateral_noise, {"lateral_noise", "m", "deviation of a predicted position, sideways", 1e-3, 1});
  visit(o.position_noise,
        {"position_noise", "m", "state observer: least standard deviation of a position", 1e-6, 1e3});
  visit(o.heading_noise,
        {"heading_noise", "rad", "state observer: least standard deviation of a heading", 1e-6, 1e3});
}

/// Options of the planner, besides those of the solver and of the vehicle model.
/// `visit_options` below describes the fields.
struct PlannerOptions {
  double control_period = 0.025;
  double latency = 0;
  double observer_time_constant = 0.1;  ///< Only models whose tyres do not slip use it.
  double max_speed = 100;
  double profile_friction = 0;
  double steer_limit = 0.4189;
  double steer_resolution = 0;
  double map_resolution = 0.05;  ///< With a model whose tyres slip, no map reaches further than 600 cells.
  double laser_x = 0.275;
  double laser_y = 0;
  double laser_yaw = 0;
  double speed_lookahead = 0;  ///< Only models whose tyres do not slip use it.
  double deadline = 0;
  /// The car also brakes off the course. Without `verify_plan`, and with a model whose tyres slip, it brakes
  /// only there: such a model plans its braking itself.
  bool stop_when_blocked = true;
  /// The other sequence is the cheapest of nominal sequence, guides and best sample that does not collide.
  /// With a model whose tyres slip, the solution also competes with slower sequences and with ways around
  /// obstacles.
  bool verify_plan = true;
  /// With a model whose tyres slip, this includes detours and smaller margins. Other models need
  /// `stop_when_blocked` and `verify_plan`.
  bool back_up = true;
  bool predict_others = true;
  double collision_probability = 0.2;
  double time_behind = 0;
  double sight_deceleration = 0;
  PerInput grip_shares = 1.0;
  EstimationOptions estimation{};  ///< estimation of state, car and ground, for models whose tyres slip
  published::PlannerOptions published{};  ///< to reproduce the program of proj-svg_mppi
};

template <class Options, class Visit>
requires is_options_of<Options, PlannerOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.control_period, {"control_period", "s", "time from one update to the next", 1e-3, 1});
  visit(o.latency,
        {"latency", "s", "time from the scan to the moment when the command reaches the car", 0, 1});
  visit(o.observer_time_constant,
        {"observer_time_constant", "s", "time constant of the lag in the steering observer", 1e-3, 10});
  visit(o.max_speed, {"max_speed", "m/s", "upper bound of the path's speeds", 0.01, 100});
  visit(o.profile_friction,
        {"profile_friction", "", "friction coefficient to which the path's speeds are lowered; 0: they stay",
         0, 3});
  visit(o.steer_limit, {"steer_limit", "rad", "bound of the steering commands, to either side", 0.01, 1.5});
  visit(
      o.steer_resolution,
      {"steer_resolution", "rad",
       "with a model whose tyres slip: steering commands are multiples of this angle; 0: any angle", 0, 0.5});
  visit(o.map_resolution,
        {"map_resolution", "m",
         "size of a cell of the maps of obstacles; those of the path have cells twice as large", 0.01, 1});
  visit(o.laser_x, {"laser_x", "m", "position of the laser ahead of the rear axle", -10, 10});
  visit(o.laser_y, {"laser_y", "m", "position of the laser to the left of the rear axle", -10, 10});
  visit(o.laser_yaw, {"laser_yaw", "rad", "direction of the laser", -7, 7});
  visit(o.speed_lookahead,
        {"speed_lookahead", "s",
         "the commanded speed is the path's this far ahead, or the plan's where acceleration is an input", 0,
         2});
  visit(o.deadline, {"deadline", "s", "time limit of a solve; 0: none", 0, 1});
  visit(o.stop_when_blocked, {"stop_when_blocked", "", "brake when every plan collides"});
  visit(o.verify_plan, {"verify_plan", "", "if the solution collides, send another sequence that does not"});
  visit(o.back_up, {"back_up", "", "reverse a little where the car stands and every plan collides"});
  visit(o.predict_others,
        {"predict_others", "", "meet other cars that are tracked where they will be, not where they are"});
  visit(o.collision_probability,
        {"collision_probability", "",
         "probability of a collision with another car in a step, above which a plan collides", 0, 1});
  visit(o.time_behind, {"time_behind", "s",
                        "with a model whose tyres slip: for how long a plan that ends behind a slower car "
                        "loses time; 0: no cost",
                        0, 1000});
  visit(o.sight_deceleration, {"sight_deceleration", "m/s^2",
                               "with objective lap_time: a car that brakes with it stops on the path that "
                               "the scan shows; 0: no limit",
                               0, 100});
  visit(o.grip_shares, {"grip_shares", "",
                        "with objective lap_time: share of usable_grip for the path's speeds; one value, or "
                        "one for each equal part of the path",
                        0.05, 1, "", true});
  visit_options(o.estimation, visit);
  visit(o.published.maps, {"published_maps", "", "cost map and reference field as in the paper's program"});
  visit(o.published.wrap_steer,
        {"wrap_steer", "", "subtract whole turns from the planned steering angle; paper's program: true"});
}

}  // namespace slalom::vehicle
