#pragma once

#include <optional>

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

/// A scan of a laser scanner.
struct SeenScan {
  maps::Pose sensor;              ///< pose of the scanner
  std::span<const float> ranges;  ///< m
};

/// Facts about a subject that do not change.
struct SubjectFacts {
  std::string title{};                                   ///< name of the problem
  std::vector<std::string> states{}, inputs{}, terms{};  ///< names of states, inputs and cost terms
  double length = 0, width = 0;                          ///< m, of the body; 0: it is a dot
  bool can_place = false, can_move = false;              ///< whether body and shapes can be dragged
  bool can_collide = true;                               ///< whether a state can collide
  std::optional<maps::OccupancyGrid> map{};              ///< drawn under the scene
  std::vector<std::string> statuses{};  ///< names of the values of FrameSource::status, if it has its own

  // Facts that only a car on a course has.
  bool can_add = false;                ///< whether shapes can be added and removed
  bool can_delay = false;              ///< whether its commands can take effect later: DriveRequest::delay
  bool fixes_seed = false;             ///< whether its drive sets the seed and threads of its solver
  bool scans_ahead = false;            ///< whether it plans with a scan of the end of the step before
  std::vector<std::string> figures{};  ///< names of FrameSource::figures, which replace states and inputs
  double front = 0, rear = 0;          ///< m from the position to the axles; 0: it has no wheels
  int speed = -1, steering = -1;       ///< indices of a state's speed (m/s) and steering (rad); -1: none
  std::optional<Scanner> scanner{};    ///< scanner of FrameSource::scan
  std::vector<maps::ReferencePoint> course{};  ///< the line to follow, with the speeds on it
  bool is_closed = false;                      ///< whether the end of the course is its beginning
};

/// Options of one kind.
struct OptionSection {
  std::string name;                  ///< a method, or what else the options belong to
  std::vector<OptionEntry> options;  ///< options with their present values
};

/// A lap that was driven.
struct DrivenLap {
  int end = 0;         ///< control steps until its end
  int lap = 0;         ///< from 1
  double time = 0;     ///< s
  int contacts = 0;    ///< collisions in this lap
  std::string method;  ///< method that drove at its end
  bool ghost = false;  ///< whether the ghost has driven it
};

/// Facts with which a step begins.
struct DriveRequest {
  double elapsed = 0;  ///< s since the last solve
  double delay = 0;    ///< s by which the command takes effect later than the settings say
  int solves = 1;      ///< how often to solve; some subjects need several for a plan that fits a change
};

/// Figures of a step that a subject measures itself.
struct StepMeasures {
  double time = 0;             ///< s since the start
  double update_time = 0;      ///< s of wall clock that the plan took
  bool collides = false;       ///< whether the body collides
  int collisions = 0;          ///< collisions until now
  double prediction_step = 0;  ///< s of a step of the plan
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

  virtual std::optional<SeenScan> scan() const { return {}; }          ///< scan with which it has planned
  virtual std::vector<double> figures() { return {}; }                 ///< values of SubjectFacts::figures
  virtual std::string blocks() { return {}; }                          ///< further blocks of the message
  virtual std::optional<StepMeasures> measures() const { return {}; }  ///< figures of the last plan
};

/// A controller in its world, as the live view drives it. All functions are called by one thread.
class Subject : public virtual FrameSource {
 public:
  /// Returns a copy that continues bit for bit like the original.
  virtual std::unique_ptr<Subject> clone() const = 0;
  virtual std::vector<double> start() const = 0;     ///< the state at the beginning
  virtual double time_step() const = 0;              ///< s; 0: unknown
  virtual const SolverOptions* options() const = 0;  ///< null with a solver of the user's own
  /// Replaces the method or its options. Throws std::invalid_argument if one is not valid; the subject is
  /// then not to be used any more, as with `set_parameter` and `apply`.
  virtual void set_options(const SolverOptions& options) = 0;
  /// The options with which another method begins. If there are none, it takes its defaults, with horizon,
  /// samples, bounds and seed of the present method.
  virtual std::optional<SolverOptions> options_of(const std::string& /*method*/) const { return {}; }
  /// The parameters: all options but those of the present method.
  virtual std::vector<OptionSection> parameters() const { return {}; }
  /// Sets a parameter; false if there is none of that name. Throws std::invalid_argument out of its range.
  virtual bool set_parameter(const std::string& /*section*/, const std::string& /*name*/,
                             const std::string& /*text*/) {
    return false;
  }
  /// Puts into effect what was set, if that has not happened yet. Throws std::invalid_argument if options
  /// contradict each other.
  virtual void apply() {}

  /// Begins anew, with the present options and parameters.
  virtual void restart() = 0;
  /// Function that is called with the solver's result and the s of wall clock that it took.
  using OnPlan = std::function<void(const SolveResult& solve, double seconds)>;
  /// Plans from a state, calls `on_plan`, in which the functions of FrameSource tell of this plan, and
  /// returns the state a step later.
  virtual std::vector<double> drive(std::span<const double> state, const DriveRequest& request,
                                    const OnPlan& on_plan) = 0;
  /// Returns the laps that were driven, in their order.
  virtual std::span<const DrivenLap> laps() const { return {}; }

  /// Puts the body of a state elsewhere. This and the functions below throw std::invalid_argument if that is
  /// not possible; the subject is then not to be used any more.
  virtual void place(std::span<double> state, const maps::Pose& to) = 0;
  /// Puts a shape elsewhere, by its index in `shapes`.
  virtual void move(int shape, const maps::Pose& to) = 0;
  /// Adds a shape behind the others, with SubjectFacts::can_add.
  virtual void add(const Shape& /*shape*/) {}
  /// Removes a shape, with SubjectFacts::can_add.
  virtual void remove(int /*shape*/) {}
};

/// A subject whose controller solves first, and whose system then moves by a step. `Controller` and the
/// controllers of Python have one; `serve` makes it.
class SolverSubject : public Subject {
 public:
  /// Solves from a state and returns the solver's result.
  virtual const SolveResult& solve(std::span<const double> state, const SolveRequest& request) = 0;
  /// Returns the state of the real system a step after `state`.
  virtual std::vector<double> step(std::span<const double> state, std::span<const double> input) = 0;

  void restart() override;
  std::vector<double> drive(std::span<const double> state, const DriveRequest& request,
                            const OnPlan& on_plan) override;

 protected:
  double time_ = 0;  ///< s since the start
};

}  // namespace slalom::view
