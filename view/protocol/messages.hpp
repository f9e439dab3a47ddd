#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slalom/evaluation/environment.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"

/// The text messages to the page (docs/live-view.md, "Messages").
namespace slalom::view {

/// The scenario, with the names of the command line.
struct ScenarioNames {
  std::string course = "stag";
  std::string method = "svg_mppi";
  std::string config = "default";
  std::uint64_t seed = 0;
  int obstacles = 0;
  int opponents = 0;
  bool operator==(const ScenarioNames&) const = default;
};

/// The available choices.
struct Choices {
  std::vector<std::string> courses, methods, configurations;
  /// The index of a method; the number of methods if it is not among them.
  int method_index(const std::string& method) const;
};

/// Names and sizes that do not change while a server runs. `history`: s of the drive that are stored;
/// `control_period`: s.
std::string hello_message(const evaluation::Environment& environment, const Choices& choices, double history,
                          double control_period);

struct OptionsFacts {
  ScenarioNames names;
  const vehicle::Configuration& now;
  const vehicle::Configuration& loaded;  ///< the configuration without the changes
  const std::string& further_arguments;  ///< further arguments of the command line, begin with a space
  std::size_t undo = 0, redo = 0;        ///< number of steps
};
/// Returns declaration and value of every option, and the equivalent command line.
std::string options_message(const OptionsFacts& facts);

/// Returns the command line of the same drive.
std::string command_line(const OptionsFacts& facts);

/// A lap that was driven.
struct LapNote {
  int tick = 0;  ///< at its end
  int lap = 0;   ///< from 1
  double time = 0;
  int contacts = 0;
  std::string method;
  bool ghost = false;  ///< driven by the ghost
};

/// A drive as the page is told of it.
struct DriveState {
  ScenarioNames names;
  std::vector<LapNote> laps{};
  double time = 0, rate = 1;                ///< s; simulated to real time, 0: as fast as possible
  double pace = 0;                          ///< simulated to real time, measured; 0: not known
  int tick = -1, newest = -1, oldest = -1;  ///< the one shown, and the range of the stored ones
  bool paused = false, real_time = false, edited = false;
  bool introduction = false;  ///< the scenario with which the program starts without arguments, unchanged
  std::string ghost{};        ///< its method; empty if there is none
  std::string ghost_label{};  ///< name of the ghost
  int generation = 0;         ///< number of drives that have begun
};
std::string state_message(const DriveState& state, const evaluation::Environment& environment,
                          double control_period);

}  // namespace slalom::view
