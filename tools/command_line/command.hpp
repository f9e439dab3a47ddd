#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// How the program's commands declare what they accept. The parser behind it (CLI11) is compiled once, in
/// command.cpp.
namespace slalom::tools {

/// An option with a value that it must not have, or options that do not go together.
struct CommandLineError : std::runtime_error {
  CommandLineError(const std::string& option_name, const std::string& broken_rule)
      : std::runtime_error(option_name + ": " + broken_rule), option(option_name), rule(broken_rule) {}
  std::string option, rule;
};

/// An option of a command while it is being declared. Refers to the command, which must outlive it.
class Option {
 public:
  explicit Option(CLI::Option* parsed) : parsed_(parsed) {}

  Option& required(bool needed = true);
  /// The help shows the variable's value at this moment as the default.
  Option& show_default();
  /// Values outside [least, most] are rejected.
  Option& range(int least, int most);
  Option& range(double least, double most);
  /// A list is given as one text with commas between its values.
  Option& comma_separated();
  /// A list is given by repeating the option, one value each time.
  Option& repeatable();
  Option& needs(const Option& other);
  Option& excludes(const Option& other);
  /// Replaces the help text.
  Option& describe(const std::string& help);

 private:
  CLI::Option* parsed_;
};

/// A sub-command of the program: its options and what it does.
class Subcommand {
 public:
  /// Declares on `parser`, which belongs to the caller.
  explicit Subcommand(CLI::App& parser) : parser_(parser) {}
  Subcommand(const Subcommand&) = delete;
  Subcommand& operator=(const Subcommand&) = delete;

  void summary(const std::string& text);
  /// Text below the options in the help.
  void footer(const std::string& text);

  /// Declares an option whose value goes to `value`, which must live as long as the action. A name without
  /// dashes declares a positional argument.
  Option option(const std::string& name, std::string& value, const std::string& help);
  Option option(const std::string& name, int& value, const std::string& help);
  Option option(const std::string& name, std::uint16_t& value, const std::string& help);
  Option option(const std::string& name, std::uint64_t& value, const std::string& help);
  Option option(const std::string& name, double& value, const std::string& help);
  Option option(const std::string& name, std::optional<double>& value, const std::string& help);
  Option option(const std::string& name, std::vector<std::string>& value, const std::string& help);
  Option flag(const std::string& name, bool& value, const std::string& help);

  /// An option that has been declared. Throws std::invalid_argument if there is none of this name.
  Option find(const std::string& name);
  /// Whether the user gave the option.
  bool given(const std::string& name) const;
  /// Whether the user gave no options but some of these.
  bool given_only(const std::vector<std::string>& names) const;

  /// Runs the command once its options are set. Returns the exit status of the program; may throw.
  void action(std::function<int()> run) { action_ = std::move(run); }
  int run() const { return action_(); }

 private:
  CLI::App& parser_;
  std::function<int()> action_;
};

/// A command by its name, and the function that declares it.
struct CommandEntry {
  const char* name;
  void (*declare)(Subcommand& command);
};

/// Parses the command line, checks it and runs the command that it names. Prints help, version and errors.
/// Returns the exit status: 0 success, 1 failure of the command, 2 a command line that cannot be understood.
int run_command_line(int argc, const char* const* argv, const std::vector<CommandEntry>& commands);

}  // namespace slalom::tools
