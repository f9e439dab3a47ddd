#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <optional>
#include <vector>

#include "slalom/core/error.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// Commands of the program and their options. Only command.cpp includes the parser, CLI11.
namespace slalom::tools {

/// A mistake on the command line: the program ends with status 2. The message reads `--option: requirement`.
struct CommandLineError : std::runtime_error {
  CommandLineError(const std::string& option, const std::string& requirement)
      : std::runtime_error(option + ": " + requirement) {}
  /// The message reads `--option: 'value' requirement`.
  CommandLineError(const std::string& option, const std::string& value, const std::string& requirement)
      : CommandLineError(option, "'" + value + "' " + requirement) {}
};

/// Calls `action` and returns its result. If `action` rejects a value, which throws std::invalid_argument or
/// IoError, throws a CommandLineError of this option with the same message.
template <class Action>
auto for_option(const std::string& option, Action&& action) {
  try {
    return action();
  } catch (const std::invalid_argument& error) {
    throw CommandLineError(option, error.what());
  } catch (const IoError& error) {
    throw CommandLineError(option, error.what());
  }
}

/// The rule of an option's values, beyond that of its type.
struct Rules {
  double least = -std::numeric_limits<double>::infinity();  ///< numbers in [least, most]
  double most = std::numeric_limits<double>::infinity();
  bool required = false;         ///< the command cannot run without the option
  bool comma_separated = false;  ///< a list in one text; else each use of the option has a value of the list
  const char* needs = nullptr;   ///< an option declared before, without which it is rejected
  std::vector<const char*> excludes{};  ///< options declared before, with which it is rejected
};

/// A command of the program: its options and its action.
class Subcommand {
 public:
  /// Declares on `parser`, which belongs to the caller.
  explicit Subcommand(CLI::App& parser) : parser_(parser) {}
  Subcommand(const Subcommand&) = delete;
  Subcommand& operator=(const Subcommand&) = delete;

  /// Sets the first line of the help.
  void summary(const std::string& text);
  /// Sets the end of the help: `text`, and command lines without the name of the program.
  void examples(std::initializer_list<const char*> commands, const std::string& text = "");

  /// Declares an option whose value goes to `value`, which must live as long as the action. A name without
  /// dashes declares a positional argument. The help shows the present value as the default, unless it is
  /// empty or outside the range. Every value that is not a number, not in the range, or empty is rejected in
  /// the same words. The value: std::string, std::vector<std::string>, int, std::uint16_t, std::uint64_t,
  /// double, or std::optional<double>.
  template <class Value>
  void option(const std::string& name, Value& value, const std::string& help, const Rules& rules = {});
  /// Declares --json, the file to which the command writes `what`.
  void json(std::string& file, const std::string& what);
  void flag(const std::string& name, bool& value, const std::string& help, const Rules& rules = {});

  /// Whether the user gave the option.
  bool given(const std::string& name) const;
  /// Whether the user gave no options but some of these.
  bool given_only(const std::vector<std::string>& names) const;

  /// Sets what the command does with its options. It returns the exit status of the program, and may throw.
  void action(std::function<int()> run) { action_ = std::move(run); }
  int run() const { return action_(); }

 private:
  void set(CLI::Option* option, const Rules& rules);

  CLI::App& parser_;
  std::function<int()> action_;
};

/// The name of a command, and the function that declares it.
struct CommandEntry {
  const char* name;
  void (*declare)(Subcommand& command);
};

/// Parses the command line, checks it and runs the command that it names. Prints help, version and errors.
/// Returns the exit status: 0 success, 1 failure of the command, 2 a mistake on the command line.
int run_command_line(int argc, const char* const* argv, const std::vector<CommandEntry>& commands);

}  // namespace slalom::tools
