#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>

namespace slalom::evaluation {

/// Describes a figure of a lap. Tables, CSV and JSON files and Python call it by this name.
struct Figure {
  const char* name;         ///< name in tables and files
  const char* unit;         ///< unit; empty for numbers without one
  const char* help;         ///< a few words on its meaning
  bool wall_clock = false;  ///< depends on the machine; all other figures repeat exactly
};

/// The figures of a lap. Means are over its control steps. `visit_figures` below describes the fields.
struct LapFigures {
  std::uint64_t seed = 0;
  bool success = false, finished = false, timeout = false;
  int collisions = 0, collided_bodies = 0;
  bool hit_wall = false;
  double time = 0;  ///< s
  int steps = 0;
  double state_cost = 0, collision_cost = 0, input_error = 0;
  double mean_speed = 0;                                 ///< m/s
  double mean_path_distance = 0, max_path_distance = 0;  ///< m
  /// Least clearance over the control steps, m: from the corners of the car to a wall (0 in a wall, with the
  /// error of Track::distance_to_wall) and from its outline to other bodies (negative in a collision).
  /// Infinite if there are neither walls nor bodies.
  double min_clearance = 0;
  double mean_variance = 0;  ///< rad^2
  double mean_effective_samples = 0;

  /// MS = state_cost + collision_cost
  double mean_sequence_cost() const { return state_cost + collision_cost; }
};

/// Calls `visit(field, Figure)` for every figure in the order of tables.
template <class Figures, class Visit>
requires std::derived_from<std::remove_const_t<Figures>, LapFigures>
void visit_figures(Figures& f, Visit&& visit) {
  visit(f.seed, Figure{"seed", "", "seed of the random numbers"});
  visit(f.success, Figure{"success", "", "finished without a collision"});
  visit(f.finished, Figure{"finished", "", "the car reached the finish in time"});
  visit(f.timeout, Figure{"timeout", "", "the lap was stopped at its timeout"});
  visit(f.collisions, Figure{"collisions", "", "collisions as the protocol counts them"});
  visit(f.collided_bodies, Figure{"collided_bodies", "", "different bodies hit, all walls as one"});
  visit(f.hit_wall, Figure{"hit_wall", "", "the car hit a wall"});
  visit(f.time, Figure{"time", "s", "time of the lap, or until it was stopped"});
  visit(f.steps, Figure{"steps", "", "control steps"});
  visit(f.state_cost, Figure{"state_cost", "", "mean cost of distance and yaw error"});
  visit(f.collision_cost, Figure{"collision_cost", "", "mean cost of collisions"});
  visit(f.input_error, Figure{"input_error", "rad", "mean of the sum of |steering| over the sequence sent"});
  visit(f.mean_speed, Figure{"mean_speed", "m/s", "mean speed"});
  visit(f.mean_path_distance,
        Figure{"mean_path_distance", "m", "mean distance of the rear axle to the path"});
  visit(f.max_path_distance,
        Figure{"max_path_distance", "m", "largest distance of the rear axle to the path"});
  visit(f.min_clearance,
        Figure{"min_clearance", "m", "least distance to a wall or body, negative in a body"});
  visit(f.mean_variance,
        Figure{"mean_variance", "rad^2", "variance of the sampled steering, mean over solves"});
  visit(f.mean_effective_samples,
        Figure{"mean_effective_samples", "", "effective sample size of the solver, mean over solves"});
}

}  // namespace slalom::evaluation
