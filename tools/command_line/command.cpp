#include "tools/command_line/command.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <deque>
#include <iostream>
#include <new>
#include <sstream>

#include "slalom/core/instruction_set.hpp"
#include "slalom/core/option_access.hpp"
#include "slalom/core/version.hpp"
#include "tools/command_line/checks.hpp"
#include "tools/command_line/words.hpp"

namespace slalom::tools {
namespace {

constexpr int names_width = 26;  // columns of the names of options
constexpr int widest = 110;      // a line of text that is longer is hard to read

/// Breaks a text into lines of at most `width` characters, the first of which begins after `used` of them.
/// Lines after the first begin with `indent` spaces, in lists (lines of the text that begin with two spaces)
/// with four. Commands stay whole.
std::string wrapped(const std::string& text, int width, int indent, int used) {
  std::istringstream lines(text);
  std::string result, line;
  for (bool is_first = true; std::getline(lines, line); is_first = false) {
    int hang = indent;
    if (!is_first) result += '\n', used = 0;
    if (line.starts_with("  slalom ")) {  // a command, which is copied
      result += line;
      continue;
    }
    if (line.starts_with("  ")) {  // an entry of a list
      result += "  ";
      used = 2;
      hang = 4;
    }
    std::istringstream words(line);
    bool is_line_start = true;
    for (std::string word; words >> word; is_line_start = false) {
      const int length = static_cast<int>(word.size());
      if (!is_line_start && used + 1 + length > width) {
        result += '\n' + std::string(static_cast<std::size_t>(hang), ' ');
        used = hang;
        is_line_start = true;
      }
      result += (is_line_start ? "" : " ") + word;
      used += length + (is_line_start ? 0 : 1);
    }
  }
  return result;
}

/// Help that is as wide as the terminal: names of options in the first columns, what they do in the others.
class HelpFormatter : public CLI::Formatter {
 public:
  explicit HelpFormatter(int width);

  std::string make_description(const CLI::App* command) const override;
  std::string make_footer(const CLI::App* command) const override;
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_subcommand(const CLI::App* command) const override;

 private:
  std::string entry(const std::string& name, const std::string& text) const;

  int width_;
};

HelpFormatter::HelpFormatter(int width) : width_(std::min(width, widest)) {}

std::string HelpFormatter::entry(const std::string& name, const std::string& text) const {
  std::string line = "  " + name;
  if (text.empty()) return line + "\n";
  if (line.size() + 2 > names_width)
    line += '\n' + std::string(names_width, ' ');
  else
    line.resize(names_width, ' ');
  return line + wrapped(text, width_, names_width, names_width) + "\n";
}

std::string HelpFormatter::make_description(const CLI::App* command) const {
  return wrapped(command->get_description(), width_, 0, 0) + "\n";
}

std::string HelpFormatter::make_footer(const CLI::App* command) const {
  const std::string footer = command->get_footer();
  return footer.empty() ? "" : wrapped(footer, width_, 0, 0) + "\n";
}

std::string HelpFormatter::make_option(const CLI::Option* option, bool is_positional) const {
  std::string name = make_option_name(option, is_positional);
  if (name == "-h,--help") return entry(name, "Print this help");
  if (option->get_items_expected_max() > 0) {
    name += is_positional ? "" : " " + option->get_type_name();
    std::string preset = option->get_default_str();
    std::erase_if(preset, [](char c) { return c == '[' || c == ']'; });  // around a list
    if (!preset.empty()) name += "=" + preset;
  }
  return entry(name, (option->get_required() ? "Required. " : "") + option->get_description());
}

std::string HelpFormatter::make_subcommand(const CLI::App* command) const {
  return entry(command->get_name(), command->get_description());
}

std::string range_number(double value) {
  const bool is_short = std::abs(value) < 1e15 && value == std::floor(value);
  return is_short ? std::to_string(static_cast<std::int64_t>(value)) : to_text(value);
}

/// "must be a whole number in [1, 10]"
std::string rule_text(bool is_whole, const Rules& range) {
  const std::string text = is_whole ? "must be a whole number" : "must be a number";
  if (std::isinf(range.least)) return text;
  if (std::isinf(range.most)) return text + " from " + range_number(range.least);
  return text + " in [" + range_number(range.least) + ", " + range_number(range.most) + "]";
}

bool contains(const Rules& range, double value) {
  return value >= range.least && value <= range.most;
}

/// Lets an option take only the numbers that a type can hold and that are in the range. The parser converts
/// the text only after this check.
template <class Value>
void check_numbers(CLI::Option* option, Rules range) {
  constexpr bool is_whole = std::is_integral_v<Value>;
  if constexpr (std::is_unsigned_v<Value>) range.least = 0;
  if constexpr (sizeof(Value) < sizeof(int)) range.most = std::numeric_limits<Value>::max();
  option->type_name(is_whole ? "INT" : "NUMBER");
  option->check([range](const std::string& text) {
    Value number{};
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, number);
    const bool accepted =
        read.ec == std::errc{} && read.ptr == end && contains(range, static_cast<double>(number));
    return accepted ? "" : "'" + text + "' " + rule_text(is_whole, range);
  });
}

}  // namespace

void Subcommand::set(CLI::Option* option, const Rules& rules) {
  option->required(rules.required);
  if (rules.needs) option->needs(parser_.get_option(rules.needs));
  for (const char* other : rules.excludes) option->excludes(parser_.get_option(other));
}

void Subcommand::summary(const std::string& text) {
  parser_.description(text);
}

void Subcommand::examples(std::initializer_list<const char*> commands, const std::string& text) {
  std::string footer = text.empty() ? "" : text + "\n\n";
  footer += "Examples:";
  for (const char* command : commands) footer += std::string("\n  slalom ") + command;
  parser_.footer(footer);
}

template <class Value>
void Subcommand::option(const std::string& name, Value& value, const std::string& help, const Rules& rules) {
  CLI::Option* const parsed = parser_.add_option(name, value, help);
  if constexpr (requires { value.empty(); }) {
    if (!value.empty()) parsed->capture_default_str();
    // An empty value usually comes from a shell variable that is not set.
    parsed->check([](const std::string& text) { return text.empty() ? "the value must not be empty" : ""; });
    if (rules.comma_separated)
      parsed->delimiter(',');
    else if (!std::is_same_v<Value, std::string>)
      parsed->allow_extra_args(false);
  } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
    check_numbers<double>(parsed, rules);
  } else {
    if (contains(rules, static_cast<double>(value))) parsed->capture_default_str();
    check_numbers<Value>(parsed, rules);
  }
  set(parsed, rules);
}

template void Subcommand::option(const std::string&, std::string&, const std::string&, const Rules&);
template void Subcommand::option(const std::string&, std::vector<std::string>&, const std::string&,
                                 const Rules&);
template void Subcommand::option(const std::string&, int&, const std::string&, const Rules&);
template void Subcommand::option(const std::string&, std::uint16_t&, const std::string&, const Rules&);
template void Subcommand::option(const std::string&, std::uint64_t&, const std::string&, const Rules&);
template void Subcommand::option(const std::string&, double&, const std::string&, const Rules&);
template void Subcommand::option(const std::string&, std::optional<double>&, const std::string&,
                                 const Rules&);

void Subcommand::flag(const std::string& name, bool& value, const std::string& help, const Rules& rules) {
  set(parser_.add_flag(name, value, help), rules);
}

void Subcommand::json(std::string& file, const std::string& what) {
  option("--json", file, "Write " + what + " as JSON to this file, or to standard output: -");
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

/// Throws CommandLineError, IoError, and std::invalid_argument for an unknown SLALOM_TARGET.
void check(const CLI::App& command) {
  std::vector<GivenOption> given;
  for (const CLI::Option* option : command.get_options())
    if (option->count() > 0 && option->get_expected_max() > 0)
      given.push_back({option->get_name(), option->get_positional(), option->results()});
  check_files(given);
  // Solvers ask for the target in functions that cannot throw.
  simd::active_target();
}

/// "; did you mean drive?" for a word near one of a list, otherwise empty.
std::string suggestion(const std::string& typed, const std::vector<std::string>& words) {
  const std::string nearest = nearest_name(typed, words);
  return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

/// The message for arguments that no command or option takes.
std::string unexpected(const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands()) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command->get_options())
      if (!option->get_positional()) names.push_back(option->get_name());
    for (const std::string& typed : app.remaining(true)) {
      const std::string name = typed.substr(0, typed.find('='));
      return name + ": is not an option of " + command->get_name() +
             (name.rfind("--", 0) == 0 ? suggestion(name, names) : "");
    }
  }
  return "unexpected arguments";
}

/// The parser's error in the words of all others.
std::string message_of(const CLI::ParseError& error, const CLI::App& app) {
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) return unexpected(app);
  std::string text = error.what();
  constexpr std::pair<const char*, const char*> words[] = {{" is required", ": is required"},
                                                           {" requires ", ": needs "},
                                                           {" excludes ", ": cannot be combined with "},
                                                           {": 1 required ", ": needs a value; "}};
  for (const auto& [theirs, ours] : words)
    if (const auto at = text.find(theirs); at != std::string::npos)
      return text.replace(at, std::string_view(theirs).size(), ours);
  return text;
}

int report(const std::string& what, int exit_status) {
  std::cerr << "slalom: " << shortened(what) << "\n";
  return exit_status;
}

int parse_and_run(int argc, const char* const* argv, const std::vector<CommandEntry>& entries) {
  int exit_status = 0;
  std::vector<std::string> names;
  for (const CommandEntry& entry : entries) names.emplace_back(entry.name);
  if (argc < 2) throw CommandLineError("slalom", "needs a command; slalom --help lists them");
  if (argv[1][0] != '-' && std::find(names.begin(), names.end(), argv[1]) == names.end())
    throw CommandLineError(argv[1], "is not a command" + suggestion(argv[1], names));
  CLI::App app{
      "Slalom: real-time sampling-based stochastic optimal control; drives, evaluates and shows 1/10-scale "
      "cars",
      "slalom"};
  app.formatter(std::make_shared<HelpFormatter>(terminal_columns(stdout)));
  app.set_version_flag("--version", std::string("slalom ") + version());
  app.require_subcommand(1);
  std::deque<Subcommand> commands;
  for (const CommandEntry& entry : entries) {
    CLI::App* parser = app.add_subcommand(entry.name);
    Subcommand& command = commands.emplace_back(*parser);
    entry.declare(command);
    parser->callback([&command, &exit_status] { exit_status = command.run(); });
  }
  app.parse_complete_callback([&app] {
    for (const CLI::App* command : app.get_subcommands()) check(*command);
  });
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    return report(message_of(error, app), 2);
  }
  return exit_status;
}

int run_guarded(int argc, const char* const* argv, const std::vector<CommandEntry>& commands) {
  try {
    guard_standard_streams();
    return parse_and_run(argc, argv, commands);
  } catch (const std::bad_alloc&) {
    return report("not enough memory; use fewer samples or a shorter horizon", 1);
  } catch (const CommandLineError& error) {
    return report(error.what(), 2);
  } catch (const std::invalid_argument& error) {  // a setting that breaks a rule of the library
    return report(error.what(), 2);
  } catch (const std::exception& error) {
    return report(error.what(), 1);
  }
}

}  // namespace

int run_command_line(int argc, const char* const* argv, const std::vector<CommandEntry>& commands) {
  return after_output(run_guarded(argc, argv, commands));
}

}  // namespace slalom::tools
