#pragma once

#include "slalom/view/drawn_solve.hpp"
#include "slalom/view/subject.hpp"

/// The message of a control step contains everything that the page draws.
namespace slalom::view {

/// The names of the figures that each frame begins with, in their order.
std::vector<std::string> scalar_names(const SubjectFacts& facts);

/// Facts about a control step whose plan has been made and not yet applied.
struct StepFacts {
  int tick = 0;             ///< index of the control step
  StepMeasures measures{};  ///< `collisions` without this step where the subject measures nothing itself
  double period = 0;        ///< s of a control step
  int method = 0;           ///< index of the method
  std::vector<double> state{};
};

/// A rectangle along the axes, m.
struct Bounds {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  /// Grows to include a point.
  void include(double x, double y) {
    x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
  }
};

/// Returns a rectangle around the line of a course, with some room beside it.
Bounds bounds_of(std::span<const maps::ReferencePoint> course);

/// A frame, and what else follows from its trajectories.
struct Frame {
  std::string message;
  bool collides = false;  ///< whether the present state collides
  Bounds bounds;          ///< around all that is drawn
};

/// Encodes a control step for which has just been solved. It rolls out plan, candidates and guides,
/// outside of the measured time.
Frame encode_frame(FrameSource& source, const SolveResult& solve, const StepFacts& step);
/// Encodes a control step whose solve was copied.
Frame encode_frame(FrameSource& source, const DrawnSolve& solve, const StepFacts& step);

/// Returns the block with the message `frame` of the ghost's control step, to be appended to a frame.
std::string encode_ghost_frame(std::string_view frame);
/// Returns the message with the map and the line of the course; empty if there is neither.
std::string encode_scene(const SubjectFacts& facts);

}  // namespace slalom::view
