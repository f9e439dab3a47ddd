#include "tools/command_line/command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <deque>
#include <exception>
#include <iostream>
#include <new>

#include "slalom/core/instruction_set.hpp"
#include "slalom/core/version.hpp"
#include "tools/command_line/checks.hpp"
#include "tools/command_line/description.hpp"
#include "tools/command_line/nearest.hpp"
#include "tools/ranks/ranks.hpp"

namespace slalom::tools {

Option& Option::required(bool needed) {
  parsed_->required(needed);
  return *this;
}

Option& Option::show_default() {
  parsed_->capture_default_str();
  return *this;
}

Option& Option::range(int least, int most) {
  parsed_->check(CLI::Range(least, most));
  return *this;
}

Option& Option::range(double least, double most) {
  parsed_->check(CLI::Range(least, most));
  return *this;
}

Option& Option::comma_separated() {
  parsed_->delimiter(',');
  return *this;
}

Option& Option::repeatable() {
  parsed_->allow_extra_args(false);
  return *this;
}

Option& Option::needs(const Option& other) {
  parsed_->needs(other.parsed_);
  return *this;
}

Option& Option::excludes(const Option& other) {
  parsed_->excludes(other.parsed_);
  return *this;
}

Option& Option::describe(const std::string& help) {
  parsed_->description(help);
  return *this;
}

void Subcommand::summary(const std::string& text) {
  parser_.description(text);
}

void Subcommand::footer(const std::string& text) {
  parser_.footer(text);
}

Option Subcommand::option(const std::string& name, std::string& value, const std::string& help) {
  return Option(parser_.add_option(name, value, help));
}

Option Subcommand::option(const std::string& name, int& value, const std::string& help) {
  return Option(parser_.add_option(name, value, help));
}

Option Subcommand::option(const std::string& name, std::uint16_t& value, const std::string& help) {
  return Option(parser_.add_option(name, value, help));
}

Option Subcommand::option(const std::string& name, std::uint64_t& value, const std::string& help) {
  return Option(parser_.add_option(name, value, help));
}

Option Subcommand::option(const std::string& name, double& value, const std::string& help) {
  return Option(parser_.add_option(name, value, help));
}

Option Subcommand::option(const std::string& name, std::optional<double>& value, const std::string& help) {
  return Option(parser_.add_option(name, value, help));
}

Option Subcommand::option(const std::string& name, std::vector<std::string>& value, const std::string& help) {
  return Option(parser_.add_option(name, value, help));
}

Option Subcommand::flag(const std::string& name, bool& value, const std::string& help) {
  return Option(parser_.add_flag(name, value, help));
}

Option Subcommand::find(const std::string& name) {
  CLI::Option* found = parser_.get_option_no_throw(name);
  if (found == nullptr) throw std::invalid_argument("unknown option " + name);
  return Option(found);
}

bool Subcommand::given(const std::string& name) const {
  return parser_.count(name) > 0;
}

bool Subcommand::given_only(const std::vector<std::string>& names) const {
  const CLI::App& parsed = parser_;
  for (const CLI::Option* option : parsed.get_options())
    if (option->count() > 0 && std::find(names.begin(), names.end(), option->get_name()) == names.end())
      return false;
  return true;
}

namespace {

GivenOption given_option(const CLI::Option& option) {
  using Type = GivenOption::Type;
  const std::string type = option.get_type_name();
  const auto begins = [&](const char* with) { return type.rfind(with, 0) == 0; };
  GivenOption given{.name = option.get_name(), .positional = option.get_positional(), .values = {}};
  given.type = option.get_expected_max() == 0 ? Type::flag
               : begins("UINT")               ? Type::natural_number
               : begins("FLOAT")              ? Type::real_number
                                              : Type::text;
  for (const std::string& value : option.results()) given.values.push_back(value);
  return given;
}

/// Throws CLI::ValidationError, IoError, and std::invalid_argument for an unknown SLALOM_TARGET.
void check(const CLI::App& command) {
  std::vector<GivenOption> given;
  for (const CLI::Option* option : command.get_options())
    if (option->count() > 0) given.push_back(given_option(*option));
  try {
    check_options(given);
  } catch (const CommandLineError& error) {
    throw CLI::ValidationError(error.option, error.rule);
  }
  // Solvers ask for the target in functions that cannot throw.
  simd::active_target();
}

/// "Did you mean ...?" for a word that is not in a list; empty if no word is near.
std::string suggestion(const std::string& typed, const std::vector<std::string>& words) {
  const std::string nearest = nearest_word(typed, words);
  return nearest.empty() ? "" : "Did you mean " + nearest + "?\n";
}

/// The answer to the name of a command that does not exist.
int unknown_command(const std::string& typed, const std::vector<CommandEntry>& entries) {
  std::vector<std::string> names;
  for (const CommandEntry& entry : entries) names.emplace_back(entry.name);
  std::cerr << "slalom: '" << typed << "' is not a command. " << suggestion(typed, names)
            << "slalom --help lists all commands.\n";
  return 2;
}

/// Suggestions for the options that the parser did not expect.
std::string option_suggestions(const CLI::App& app) {
  std::string text;
  for (const CLI::App* command : app.get_subcommands()) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command->get_options())
      if (!option->get_positional()) names.push_back(option->get_name());
    for (const std::string& typed : app.remaining(true))
      if (typed.rfind("--", 0) == 0) text += suggestion(typed.substr(0, typed.find('=')), names);
  }
  return text;
}

int parse_and_run(int argc, const char* const* argv, const std::vector<CommandEntry>& entries) {
  int exit_status = 0;
  if (argc > 1 && argv[1][0] != '-' &&
      std::none_of(entries.begin(), entries.end(),
                   [&](const CommandEntry& entry) { return std::string(entry.name) == argv[1]; }))
    return unknown_command(argv[1], entries);
  CLI::App app{
      "Slalom: real-time sampling-based stochastic optimal control; drives, evaluates and shows 1/10-scale "
      "cars",
      "slalom"};
  app.set_version_flag("--version", std::string("slalom ") + version());
  app.require_subcommand(1);
  std::deque<Subcommand> commands;
  for (const CommandEntry& entry : entries) {
    CLI::App* parser = app.add_subcommand(entry.name);
    Subcommand& command = commands.emplace_back(*parser);
    entry.declare(command);
    parser->callback([&command, &exit_status] {
      try {
        exit_status = command.run();
      } catch (const CommandLineError& error) {
        throw CLI::ValidationError(error.option, error.rule);
      }
    });
  }
  app.parse_complete_callback([&app] {
    for (const CLI::App* command : app.get_subcommands()) check(*command);
  });
  try {
    app.parse(argc, argv);
  } catch (const CLI::ExtrasError& error) {
    app.exit(error);
    std::cerr << option_suggestions(app);
    return 2;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return exit_status;
}

/// Under mpirun every process meets the same error; only the first one reports it.
int report_error(const char* what) {
  if (rank() == 0) std::cerr << "slalom: " << what << "\n";
  return 1;
}

int run_guarded(int argc, const char* const* argv, const std::vector<CommandEntry>& commands) {
  try {
    guard_standard_streams();
    return parse_and_run(argc, argv, commands);
  } catch (const std::bad_alloc&) {
    return report_error("not enough memory; use fewer samples or a shorter horizon");
  } catch (const std::exception& error) {
    return report_error(error.what());
  }
}

}  // namespace

std::vector<CommandDescription> describe_commands(const std::vector<CommandEntry>& commands) {
  std::vector<CommandDescription> all;
  for (const CommandEntry& entry : commands) {
    CLI::App parser("", entry.name);
    Subcommand command(parser);
    entry.declare(command);
    CommandDescription described{entry.name, parser.get_description(), parser.get_footer(), {}};
    for (const CLI::Option* option : parser.get_options())
      if (option != parser.get_help_ptr())
        described.options.push_back({.name = option->get_name(),
                                     .help = option->get_description(),
                                     .value = option->get_expected_max() == 0 ? "" : option->get_type_name(),
                                     .preset = option->get_default_str(),
                                     .is_required = option->get_required()});
    all.push_back(std::move(described));
  }
  return all;
}

int run_command_line(int argc, const char* const* argv, const std::vector<CommandEntry>& commands) {
  return after_output(run_guarded(argc, argv, commands));
}

}  // namespace slalom::tools
