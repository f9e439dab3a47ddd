#pragma once

#include "slalom/core/polymorphic.hpp"
#include "slalom/view/subject.hpp"
#include "view/protocol/messages.hpp"

namespace slalom::view {

/// Facts about a step that do not follow from the drive, with which it is driven again exactly.
struct StepRecord {
  double delay = 0;       ///< DriveRequest::delay
  int solves = 1;         ///< DriveRequest::solves
  bool collides = false;  ///< whether the body collided
};

/// The method of a subject and all options.
struct Settings {
  std::string method{};                   ///< empty with a solver of the user's own
  std::vector<OptionSection> sections{};  ///< that of the method first

  OptionTexts texts() const;  ///< values of all options
};
Settings settings_of(const Subject& subject);
/// A subject and where its state is. A copy continues bit for bit like the original.
struct Run {
  /// Begins a drive.
  explicit Run(Polymorphic<Subject> subject);

  Polymorphic<Subject> subject;
  std::shared_ptr<const Settings> settings;  ///< method and options
  std::vector<double> state;
  double period;       ///< s of a control step
  int steps = 0;       ///< control steps until now
  int collisions = 0;  ///< steps that collided
  double elapsed = 0;  ///< s since the last solve

  /// Drives one step. `on_plan` may set `record.collides`.
  void tick(StepRecord& record, const Subject::OnPlan& on_plan);
};

/// The subject that is driven, and the ghost if there is one, each in a world of its own.
struct Drives {
  Run driven;
  std::optional<Run> ghost{};
  std::string ghost_label{};
  int ghost_start = 0;  ///< control steps before the ghost started
  bool edited = false;  ///< whether the drive differs from that of the command line

  int ticks() const noexcept { return driven.steps; }
  /// Drives one step. `records`: of what is driven, and of the ghost.
  void tick(std::array<StepRecord, 2> records);
  /// Begins anew with the present options of both.
  Drives restarted() const;
  std::vector<DrivenLap> laps() const;  ///< laps of both, in the order of their ends
};

/// Returns the values of `wanted` that differ from the settings, but none that they do not have.
OptionTexts changed_texts(const Settings& settings, const OptionTexts& wanted);
/// Returns the options with which a method begins: the subject's own, else its defaults with those that all
/// methods have from the texts of the `present` one. Throws std::invalid_argument on an unknown method.
SolverOptions method_options(const Subject& subject, const std::string& method, const OptionTexts& texts,
                             const std::string& present);

/// An action of a user between two ticks. It throws std::invalid_argument, perhaps after it has changed
/// something, if a subject rejects it.
using Action = std::function<void(Drives&)>;

// These change the scene of both.
Action add_shape(const Shape& shape);
Action move_shape(int shape, const maps::Pose& to);
Action remove_shape(int shape);
/// Puts all shapes that do not move by themselves where they were.
Action set_shapes(std::vector<Shape> shapes);

// These change what is driven, but not the ghost.
Action place_body(const maps::Pose& to);
/// Sets options by "section.option"; a key without a section is an option of the method.
Action set_options(OptionTexts texts);
/// Lets a method drive, with its options.
Action change_method(SolverOptions options);
/// Sets method and options back to earlier ones.
Action restore(Settings settings);

/// Starts a ghost as a copy of what is driven, with another method if one is given. `label`: its name.
Action start_ghost(std::string label, std::optional<SolverOptions> method = {});
/// Takes the ghost away.
void end_ghost(Drives& drives);

}  // namespace slalom::view
