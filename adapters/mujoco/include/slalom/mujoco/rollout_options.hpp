#pragma once

#include "slalom/core/options.hpp"

namespace slalom::mujoco {

/// Options of the rollouts of a model.
/// `visit_options` below describes the fields.
struct RolloutOptions {
  int physics_steps = 1;
  int threads = 1;
};

template <class Options, class Visit>
requires is_options_of<Options, RolloutOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.physics_steps,
        {"physics_steps", "",
         "time steps of the model in a step of the control sequence, with the same inputs", 1, 10000});
  visit(o.threads,
        {"threads", "", "threads that simulate, each with its own mjData; the costs do not depend on it", 1,
         1024});
}

}  // namespace slalom::mujoco
