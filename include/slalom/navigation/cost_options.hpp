#pragma once

#include "slalom/core/options.hpp"

namespace slalom::navigation {

/// Weights of the cost of a plan. A cost is an integral over the time of the plan, so that the weights do not
/// depend on the duration of a step. Their unit is that of the cost per second and per unit of the term.
struct CostOptions {
  double progress = 1.5;      ///< per m of path left in the plan's window
  double final_progress = 2;  ///< the same at the end of the plan; not per second
  double path = 2;            ///< per m^2 of squared distance from the path, of at most path_reach
  double path_reach = 1;      ///< m
  double heading = 0.4;       ///< per unit of 1 - cos(yaw error) to the path
  double clearance = 2;       ///< at contact; falls by exp(-clearance_falloff distance), and to 0 at the goal
  double clearance_falloff = 8;  ///< 1/m
  double reverse = 1.5;          ///< per m/s of reversing
  double sideways = 0.2;         ///< per m/s of driving sideways
  double turning = 0.05;         ///< per (rad/s)^2
  double unknown = 1;            ///< where the robot's origin is in a cell that is unknown and priced
  double goal_heading = 3;       ///< per unit of 1 - cos(yaw error) to the goal, near it
  double goal_reach = 0.5;       ///< m, from the goal, where that begins and clearance begins to count less
  double collision = 500;        ///< while the body overlaps an obstacle, or what moves
  double others_margin = 0.1;    ///< m, distance from predicted bodies below which a plan collides
  double others_reach = 0.4;     ///< m beyond that in which nearness has a cost
  double others = 10;            ///< at that margin; falls off as the square of the distance
  double others_probability = 0.2;  ///< of a collision with something that moves, above which a plan collides
};

/// Declares the options above.
template <class Options, class Visit>
requires is_options_of<Options, CostOptions>
void visit_options(Options& o, Visit&& visit) {
  const auto weight = [&](auto& field, const char* name, const char* unit, const char* help) {
    visit(field, Declaration{.name = name, .unit = unit, .help = help, .min = 0, .max = 1e6});
  };
  weight(o.progress, "progress", "1/(m s)", "weight of the path that is left in the plan's window");
  weight(o.final_progress, "final_progress", "1/m", "weight of the same at the end of the plan");
  weight(o.path, "path", "1/(m^2 s)", "weight of the squared distance from the path");
  visit(o.path_reach, Declaration{.name = "path_reach",
                                  .unit = "m",
                                  .help = "distance from the path above which its cost does not grow",
                                  .min = 0.01,
                                  .max = 100});
  weight(o.heading, "heading", "1/s", "weight of 1 - cos(yaw error) to the path");
  weight(o.clearance, "clearance", "1/s", "cost of a body that touches an obstacle");
  visit(o.clearance_falloff, Declaration{.name = "clearance_falloff",
                                         .unit = "1/m",
                                         .help = "rate at which that cost falls with the distance",
                                         .min = 0.01,
                                         .max = 1000});
  weight(o.reverse, "reverse", "1/m", "weight of the speed of reversing");
  weight(o.sideways, "sideways", "1/m", "weight of the speed to either side");
  weight(o.turning, "turning", "s/rad^2", "weight of the squared yaw rate");
  weight(o.unknown, "unknown", "1/s", "cost of being in an unknown cell");
  weight(o.goal_heading, "goal_heading", "1/s", "weight of 1 - cos(yaw error) to the goal");
  visit(o.goal_reach, Declaration{.name = "goal_reach",
                                  .unit = "m",
                                  .help = "distance from the goal where its heading begins to count, and "
                                          "clearance to count less",
                                  .min = 0.01,
                                  .max = 100});
  weight(o.collision, "collision", "1/s", "cost of a body that overlaps an obstacle");
  visit(o.others_margin, Declaration{.name = "others_margin",
                                     .unit = "m",
                                     .help = "distance from a moving object that counts as a collision",
                                     .min = 0,
                                     .max = 10});
  visit(o.others_reach, Declaration{.name = "others_reach",
                                    .unit = "m",
                                    .help = "distance beyond others_margin in which nearness has a cost",
                                    .min = 0,
                                    .max = 10});
  weight(o.others, "others", "1/s", "cost at a distance of others_margin from a moving object");
  visit(o.others_probability,
        Declaration{.name = "others_probability",
                    .help = "probability of a collision with a moving object above which a state collides",
                    .min = 0,
                    .max = 1});
}

}  // namespace slalom::navigation
