#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "slalom/view/subject.hpp"
#include "view/protocol/frame_writer.hpp"
#include "view/protocol/page_json.hpp"

/// The messages of a control step of a user's own problem.
namespace slalom::view {

/// The names of the figures that each frame begins with, in their order.
std::vector<std::string> problem_scalars(const SubjectFacts& facts);

/// A control step whose plan has been made and not yet applied.
struct ProblemStep {
  int tick = 0;
  double time = 0;        ///< s
  double period = 0;      ///< s of a control step
  double solve_time = 0;  ///< s of wall clock
  int collisions = 0;     ///< steps until now that collided, without this one
  int method = 0;         ///< index of the method
  std::vector<double> state;
};

/// A frame, and what else follows from its rollouts.
struct ProblemFrame {
  std::string message;
  bool collides = false;  ///< whether the present state collides
  Bounds bounds;          ///< around all that is drawn
};
ProblemFrame encode_step(Subject& subject, const SolveResult& solve, const ProblemStep& step);

}  // namespace slalom::view
