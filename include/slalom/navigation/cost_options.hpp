#pragma once

#include "slalom/core/options.hpp"

namespace slalom::navigation {

/// Weights of the cost of a plan, an integral over its time: they do not depend on the duration of a step.
/// Their unit is that of the cost per second and per unit of the term. `visit_options` below describes them.
struct CostOptions {
  double progress = 1.5;
  double final_progress = 2;
  double path = 2;
  double path_reach = 1;
  double heading = 0.4;
  double clearance = 2;
  double clearance_falloff = 8;
  double reverse = 1.5;
  double sideways = 0.2;
  double turning = 0.2;
  double unknown = 1;
  double goal_heading = 3;
  double goal_reach = 0.5;
  double collision = 500;
  double others_margin = 0.1;
  double others_reach = 0.4;
  double others = 20;
  double others_probability = 0.2;
};

template <class Options, class Visit>
requires is_options_of<Options, CostOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.progress, {"progress", "1/(m s)", "weight of the path that is left in the plan's window", 0, 1e6});
  visit(o.final_progress, {"final_progress", "1/m", "weight of the path left at the plan's end", 0, 1e6});
  visit(o.path,
        {"path", "1/(m^2 s)", "weight of the squared distance to the path, up to path_reach", 0, 1e6});
  visit(o.path_reach,
        {"path_reach", "m", "distance to the path beyond which its cost stays equal", 0.01, 100});
  visit(o.heading, {"heading", "1/s", "weight of 1 - cos(yaw error) to the path", 0, 1e6});
  visit(o.clearance,
        {"clearance", "1/s", "cost of touching an obstacle; near the goal it falls to 0", 0, 1e6});
  visit(o.clearance_falloff, {"clearance_falloff", "1/m", "fall of `clearance` with distance", 0.01, 1000});
  visit(o.reverse, {"reverse", "1/m", "weight of the speed of reversing", 0, 1e6});
  visit(o.sideways, {"sideways", "1/m", "weight of the speed to either side", 0, 1e6});
  visit(o.turning, {"turning", "s/rad^2", "weight of the squared yaw rate", 0, 1e6});
  visit(o.unknown, {"unknown", "1/s", "cost of having the origin in an unknown cell that is priced", 0, 1e6});
  visit(o.goal_heading, {"goal_heading", "1/s", "weight of 1 - cos(yaw error) to the goal, near it", 0, 1e6});
  visit(o.goal_reach,
        {"goal_reach", "m",
         "distance to the goal where goal_heading begins to count, and clearance to count less", 0.01, 100});
  visit(o.collision, {"collision", "1/s", "cost of overlapping an obstacle or a moving object", 0, 1e6});
  visit(o.others_margin, {"others_margin", "m", "distance to a moving object that is a collision", 0, 10});
  visit(o.others_reach, {"others_reach", "m", "distance beyond others_margin where nearness costs", 0, 10});
  visit(o.others, {"others", "1/s", "cost at others_margin from an object; falls as the square", 0, 1e6});
  visit(o.others_probability,
        {"others_probability", "", "probability of a collision above which a state collides", 0, 1});
}

}  // namespace slalom::navigation
