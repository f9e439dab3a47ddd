#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "slalom/view/subject.hpp"
#include "view/protocol/frame_writer.hpp"

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

/// A rectangle along the axes, m.
struct Bounds {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  /// Grows to include a point.
  void include(double x, double y) {
    x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
  }
};

/// A frame, and what else follows from its rollouts.
struct ProblemFrame {
  std::string message;
  bool collides = false;  ///< whether the present state collides
  Bounds bounds;          ///< around all that is drawn
};
ProblemFrame encode_step(Subject& subject, const SolveResult& solve, const ProblemStep& step);

}  // namespace slalom::view
