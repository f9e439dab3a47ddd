#pragma once

#include "slalom/core/options.hpp"

namespace slalom::mujoco {

/// How a model is rolled out.
struct RolloutOptions {
  int physics_steps = 1;  ///< time steps of the model in a step of the control sequence, with the same inputs
  int threads = 1;        ///< threads that simulate, each with its own mjData; the costs do not depend on it
};

/// Declares every option by name, unit, help and range.
template <class Options, class Visit>
requires is_options_of<Options, RolloutOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.physics_steps, Declaration{.name = "physics_steps",
                                     .help = "time steps of the model in a step of the control sequence",
                                     .min = 1,
                                     .max = 10000});
  visit(o.threads, Declaration{.name = "threads", .help = "threads that simulate", .min = 1, .max = 1024});
}

}  // namespace slalom::mujoco
