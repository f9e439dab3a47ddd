#pragma once

#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "slalom/core/option_access.hpp"
#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/maps/reference_path.hpp"
#include "slalom/solvers/solver.hpp"
#include "slalom/solvers/solver_options.hpp"
#include "slalom/solvers/trajectories.hpp"

namespace slalom::view {

using Line = std::vector<maps::Point>;  ///< points one after the other, m

/// The meaning of a shape.
enum class ShapeKind {
  obstacle,    ///< stands in the way
  mover,       ///< moves by itself, so it cannot be dragged
  goal,        ///< a place to reach
  parked_car,  ///< a box that is drawn as a car
  opponent,    ///< a car that drives by itself, so it cannot be dragged
};

/// Something that stands in the scene: a disc, a box or a polygon.
struct Shape {
  maps::Pose pose{};                     ///< middle of a disc or a box
  double length = 0, width = 0;          ///< m; the length of a disc is its diameter
  bool is_disc = false;                  ///< whether it is a disc, not a box
  Line corners{};                        ///< corners of a polygon; empty for a disc or a box
  ShapeKind kind = ShapeKind::obstacle;  ///< movers and goals are discs
  bool touched = false;                  ///< whether the body collides with it, where that is known
};
/// Returns a disc.
inline Shape disc(double x, double y, double radius, ShapeKind kind = ShapeKind::obstacle) {
  return {.pose = {x, y, 0}, .length = 2 * radius, .width = 2 * radius, .is_disc = true, .kind = kind};
}
/// Returns a box around its middle.
inline Shape box(const maps::Pose& middle, double length, double width) {
  return {.pose = middle, .length = length, .width = width};
}
/// Returns a polygon.
inline Shape polygon(Line corners) {
  return {.corners = std::move(corners)};
}

/// A laser scanner, as the page draws its scans.
struct Scanner {
  double angle_min = 0, angle_increment = 0;  ///< rad, of the first beam and between beams
  double range_max = 0;                       ///< m; readings from here on are not drawn
};

/// Facts about a subject that do not change.
struct SubjectFacts {
  std::string title{};                                   ///< name of the problem
  std::vector<std::string> states{}, inputs{}, terms{};  ///< names of states, inputs and cost terms
  double length = 0, width = 0;                          ///< m, of the body; 0: it is a dot
  bool can_place = false, can_move = false;              ///< whether body and shapes can be dragged
  std::optional<maps::OccupancyGrid> map{};              ///< drawn under the scene
  std::vector<std::string> statuses{};  ///< names of the values of FrameSource::status, if it has its own

  // Facts that only a car on a course has.
  std::vector<std::string> figures{};  ///< names of FrameSource::figures, which replace states and inputs
  double front = 0, rear = 0;          ///< m from the position to the axles; 0: it has no wheels
  int speed = -1, steering = -1;       ///< indices of a state's speed (m/s) and steering (rad); -1: none
  std::optional<Scanner> scanner{};    ///< scanner of the scans in FrameSource::blocks
  std::vector<maps::ReferencePoint> course{};  ///< the line to follow, with the speeds on it
  bool is_closed = false;                      ///< whether the end of the course is its beginning
};

/// Figures of a step that a subject measures itself.
struct StepMeasures {
  double time = 0;         ///< s since the start
  double update_time = 0;  ///< s of wall clock that the plan took
  bool collides = false;   ///< whether the body collides
  int collisions = 0;      ///< collisions until now
};

/// Names those that have no names, by their kind and number. `what`: where the names come from. Throws
/// std::invalid_argument if there are some names, but not `count`.
inline void fill_names(std::vector<std::string>& names, std::size_t count, const std::string& kind,
                       const std::string& what) {
  if (!names.empty() && names.size() != count)
    throw std::invalid_argument(what + ": has " + std::to_string(names.size()) + " names, must have " +
                                std::to_string(count));
  for (std::size_t i = names.size(); i < count; ++i) names.push_back(kind + " " + std::to_string(i + 1));
}

/// A controller in its world at a control step, as the live view draws it.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual const SubjectFacts& facts() const = 0;  ///< names and sizes
  /// How the last solve ended.
  virtual int status(const SolveResult& solve) const { return static_cast<int>(solve.status); }
  virtual std::span<const double> inputs() const = 0;  ///< inputs of the last plan, [step][input]
  /// Returns the number of inputs of a step.
  virtual std::size_t inputs_per_step() const { return facts().inputs.size(); }
  /// Returns the trajectories of control sequences, [sequence][step][input].
  virtual Trajectories roll_out(std::span<const double> state, std::span<const float> sequences) = 0;
  /// Returns where the body is in each of some states, [state][value].
  virtual std::vector<maps::Pose> poses(std::span<const double> states) = 0;
  virtual std::vector<Shape> shapes() = 0;          ///< discs, boxes and polygons of the scene
  virtual std::vector<Line> lines() { return {}; }  ///< lines to follow, such as a path
  /// Returns the lines that show the body in a state.
  virtual std::vector<Line> figure(std::span<const double> state) = 0;

  virtual std::vector<double> figures() { return {}; }                 ///< values of SubjectFacts::figures
  virtual std::string blocks() { return {}; }                          ///< further blocks of the message
  virtual std::optional<StepMeasures> measures() const { return {}; }  ///< figures of the last plan
};

/// A controller with its problem, as the live view drives it. `Controller` and the controllers of Python have
/// one; `serve` makes it. All functions are called by one thread.
class Subject : public FrameSource {
 public:
  /// Returns a copy that continues bit for bit like the original.
  virtual std::unique_ptr<Subject> clone() const = 0;
  virtual std::vector<double> start() const = 0;     ///< the state at the beginning
  virtual double time_step() const = 0;              ///< s; 0: unknown
  virtual const SolverOptions* options() const = 0;  ///< null with a solver of the user's own
  /// Replaces the method or its options. Throws std::invalid_argument, and nothing changes, if one is not
  /// valid.
  virtual void set_options(const SolverOptions& options) = 0;
  /// The options with which another method begins. If there are none, it takes its defaults, with horizon,
  /// samples, bounds and seed of the present method.
  virtual std::optional<SolverOptions> options_of(const std::string& /*method*/) const { return {}; }
  /// The problem's own parameters.
  virtual std::vector<OptionEntry> parameters() const { return {}; }
  /// Sets a parameter; false if there is none of that name. Throws std::invalid_argument out of its range.
  virtual bool set_parameter(const std::string& /*name*/, const std::string& /*text*/) { return false; }

  /// Begins anew, with the present options, parameters and shapes.
  virtual void restart() {}

  /// Solves from a state and returns the solver's result.
  virtual const SolveResult& solve(std::span<const double> state, const SolveRequest& request) = 0;
  /// Returns the state of the real system a step after `state`.
  virtual std::vector<double> step(std::span<const double> state, std::span<const double> input) = 0;

  /// Puts the body of a state elsewhere, or a shape.
  virtual void place(std::span<double> state, const maps::Pose& to) = 0;
  /// Puts a shape elsewhere, by its index in `shapes`.
  virtual void move(int shape, const maps::Point& to) = 0;
};

}  // namespace slalom::view
