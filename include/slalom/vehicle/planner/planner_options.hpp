#pragma once

#include "slalom/core/options.hpp"
#include "slalom/vehicle/estimation/estimation_options.hpp"
#include "slalom/vehicle/published/planner_options.hpp"

namespace slalom::vehicle {

/// Options of the planner, besides those of the solver and of the vehicle model.
struct PlannerOptions {
  double control_period = 0.025;        ///< s, from one update to the next
  double latency = 0;                   ///< s, from the scan to the moment when a command reaches the car
  double observer_time_constant = 0.1;  ///< s, of the lag in the steering observer; of models
                                        ///< whose tyres do not slip
  double max_speed = 100;               ///< m/s, upper bound of the path's speeds
  double profile_friction = 0;   ///< the path's speeds are lowered until they ask for no more than this
                                 ///< coefficient of friction allows; 0: they stay
  double steer_limit = 0.4189;   ///< rad, bound of the steering commands, to either side
  double steer_resolution = 0;   ///< rad, of a steering that settles at multiples of it only: commands are
                                 ///< such angles, with models whose tyres slip; 0: any angle
  double map_resolution = 0.05;  ///< m per cell of the maps of obstacles; those of the path have cells twice
                                 ///< as large, and with tyres that slip no map reaches further than 600 cells
  double laser_x = 0.275;        ///< m, of the laser ahead of the rear axle
  double laser_y = 0;            ///< m, to the left
  double laser_yaw = 0;          ///< rad
  double speed_lookahead = 0;    ///< s, of models whose tyres do not slip: the commanded speed is that of
                                 ///< the path this far ahead, or of the plan where the acceleration is an
                                 ///< input
  double deadline = 0;           ///< s, time limit of a solve; 0: none
  /// Brake off the course and, with `verify_plan` and a model whose tyres do not slip, when every plan
  /// collides. A model whose tyres slip plans the braking itself.
  bool stop_when_blocked = true;
  /// If the solution collides, send the cheapest of nominal sequence, guides and best sample that does not.
  /// With a model whose tyres slip, the solution also competes with slower sequences and with ways around
  /// obstacles.
  bool verify_plan = true;
  /// Reverse a little and try again where the car stands and every plan collides. With a model whose tyres
  /// slip, this includes detours and smaller margins. Other models need `stop_when_blocked` and
  /// `verify_plan`.
  bool back_up = true;
  bool predict_others = true;          ///< plans meet `PlannerInput::others` where they will be
  double collision_probability = 0.2;  ///< of others in a step, above which a plan collides
  /// s, with a model whose tyres slip: a plan that ends behind a slower car costs the time that is lost by
  /// following that car for so long; 0: such plans cost nothing
  double time_behind = 0;
  /// m/s^2, where plans seek the shortest time: the speed stays so low that a car that brakes with this
  /// deceleration stops within the part of the path that the scan shows; 0: no such limit
  double sight_deceleration = 0;
  /// Where plans seek the shortest time: the share of `usable_grip` with which the speeds of the path are
  /// computed; one value, or one for each of so many parts of the path, of equal length, from its first point
  PerInput grip_shares = 1.0;
  EstimationOptions estimation;         ///< of state, car and ground, for models whose tyres slip
  published::PlannerOptions published;  ///< to reproduce the program of proj-svg_mppi
};

/// Declares every option by name, unit, help and range.
template <class Options, class Visit>
requires is_options_of<Options, PlannerOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.control_period, Declaration{.name = "control_period",
                                      .unit = "s",
                                      .help = "from one update to the next",
                                      .min = 1e-3,
                                      .max = 1});
  visit(o.latency, Declaration{.name = "latency",
                               .unit = "s",
                               .help = "from the scan to the moment when the command reaches the car",
                               .min = 0,
                               .max = 1});
  visit(o.observer_time_constant, Declaration{.name = "observer_time_constant",
                                              .unit = "s",
                                              .help = "time constant of the lag in the steering observer",
                                              .min = 1e-3,
                                              .max = 10});
  visit(o.max_speed, Declaration{.name = "max_speed",
                                 .unit = "m/s",
                                 .help = "upper bound of the path's speeds",
                                 .min = 0.01,
                                 .max = 100});
  visit(o.profile_friction, Declaration{.name = "profile_friction",
                                        .help = "the path's speeds are lowered until they ask for no more "
                                                "than this coefficient of friction allows; 0: they stay",
                                        .min = 0,
                                        .max = 3});
  visit(o.steer_limit, Declaration{.name = "steer_limit",
                                   .unit = "rad",
                                   .help = "bound of the steering commands, to either side",
                                   .min = 0.01,
                                   .max = 1.5});
  visit(o.steer_resolution,
        Declaration{.name = "steer_resolution",
                    .unit = "rad",
                    .help = "with a model whose tyres slip: steering commands are multiples of this angle, "
                            "for a steering that settles at no other; 0: any angle",
                    .min = 0,
                    .max = 0.5});
  visit(o.map_resolution,
        Declaration{.name = "map_resolution",
                    .unit = "m",
                    .help = "size of a cell of the maps of obstacles; those of the path have cells twice as "
                            "large, and with a model whose tyres slip no map reaches further than 600 cells",
                    .min = 0.01,
                    .max = 1});
  visit(o.laser_x, Declaration{.name = "laser_x",
                               .unit = "m",
                               .help = "position of the laser ahead of the rear axle",
                               .min = -10,
                               .max = 10});
  visit(o.laser_y, Declaration{.name = "laser_y",
                               .unit = "m",
                               .help = "position of the laser to the left of the rear axle",
                               .min = -10,
                               .max = 10});
  visit(
      o.laser_yaw,
      Declaration{.name = "laser_yaw", .unit = "rad", .help = "direction of the laser", .min = -7, .max = 7});
  visit(o.speed_lookahead,
        Declaration{.name = "speed_lookahead",
                    .unit = "s",
                    .help = "the commanded speed is that of the path this far ahead, or of "
                            "the plan where the acceleration is an input",
                    .min = 0,
                    .max = 2});
  visit(o.deadline,
        Declaration{
            .name = "deadline", .unit = "s", .help = "time limit of a solve; 0: none", .min = 0, .max = 1});
  visit(o.stop_when_blocked,
        Declaration{.name = "stop_when_blocked", .help = "brake when every plan collides"});
  visit(o.verify_plan, Declaration{.name = "verify_plan",
                                   .help = "if the solution collides, send another sequence that does not"});
  visit(o.back_up, Declaration{.name = "back_up",
                               .help = "reverse a little where the car stands and every plan collides"});
  visit(o.predict_others,
        Declaration{.name = "predict_others",
                    .help = "meet other cars that are tracked where they will be, not where they are"});
  visit(o.collision_probability,
        Declaration{
            .name = "collision_probability",
            .help = "probability of a collision with another car in a step, above which a plan collides",
            .min = 0,
            .max = 1});
  visit(o.time_behind,
        Declaration{.name = "time_behind",
                    .unit = "s",
                    .help = "with a model whose tyres slip: for how long a car whose plan ends behind a "
                            "slower one is taken to lose time behind it; 0: such plans cost nothing",
                    .min = 0,
                    .max = 1000});
  visit(o.sight_deceleration,
        Declaration{.name = "sight_deceleration",
                    .unit = "m/s^2",
                    .help = "with objective lap_time: plans drive no faster than a car that brakes with it "
                            "stops on the part of the path that the scan shows; 0: no such limit",
                    .min = 0,
                    .max = 100});
  visit(o.grip_shares,
        Declaration{.name = "grip_shares",
                    .help = "with objective lap_time: share of usable_grip with which the speeds of the path "
                            "are computed: one value, or one for each of so many equal parts of the path",
                    .min = 0.05,
                    .max = 1,
                    .any_count = true});
  visit_options(o.estimation, visit);
  visit(o.published.maps, Declaration{.name = "published_maps",
                                      .help = "cost map and reference field as in the paper's program"});
  visit(o.published.wrap_steer,
        Declaration{.name = "wrap_steer",
                    .help = "subtract whole turns from the planned steering angle; paper's program: true"});
}

}  // namespace slalom::vehicle
