#pragma once

#include <map>

#include "slalom/view/subject.hpp"
#include "view/protocol/frame.hpp"

/// The text messages to the page (docs/live-view.md, "Messages").
namespace slalom::view {

/// The scenario of a car, with the names of the command line; of other subjects only the method.
struct ScenarioNames {
  std::string course{};
  std::string method{};
  std::string config{};
  std::uint64_t seed = 0;
  int obstacles = 0;
  int opponents = 0;
  std::string description{}, evaluation{};  ///< words about the course; rules of the drive
  double length = 0;                        ///< m, of the course
};

/// The available choices.
struct Choices {
  std::vector<std::string> courses{}, methods{}, configurations{};
  /// The index of a method; the number of methods if it is not among them.
  int method_index(const std::string& method) const;
};

/// Names and sizes that do not change while a subject is driven. `history`: s of the drive that are stored;
/// `control_period`: s; `can`: what the page can do.
std::string hello_message(const SubjectFacts& facts, const Choices& choices, double history,
                          double control_period, const std::vector<std::string>& can = {});

/// Values of options as text, by "section.option".
using OptionTexts = std::map<std::string, std::string>;
/// Adds the values of those options that `to` does not have yet.
void add_texts(OptionTexts& to, const std::vector<OptionSection>& sections);

/// The options of a subject.
struct OptionsFacts {
  ScenarioNames names{};
  std::vector<OptionSection> sections{};  ///< all of them
  bool fixes_seed = false;                ///< whether seed and threads are left out, and other methods
  OptionTexts loaded{};                   ///< values without the changes
  std::string further_arguments{};        ///< further arguments of the command line, begin with a space
  std::size_t undo = 0, redo = 0;         ///< number of steps
};
/// Returns declaration and value of every option, and for a scenario the equivalent command line.
std::string options_message(const OptionsFacts& facts);

/// Returns the command line of the same drive; empty without a scenario.
std::string command_line(const OptionsFacts& facts);

/// A drive as the page is told of it.
struct DriveState {
  ScenarioNames names{};
  std::vector<DrivenLap> laps{};
  double time = 0, rate = 1;                ///< s; simulated to real time, 0: as fast as possible
  double pace = 0;                          ///< simulated to real time, measured; 0: not known
  double control_period = 0;                ///< s
  int tick = -1, newest = -1, oldest = -1;  ///< the one shown, and the range of the stored ones
  bool paused = false, real_time = false, edited = false;
  std::string ghost{};        ///< its method; empty if there is none
  std::string ghost_label{};  ///< name of the ghost
  int generation = 0;         ///< number of drives that have begun
  Bounds bounds{};            ///< around all that was drawn
};
std::string state_message(const DriveState& state);

}  // namespace slalom::view
