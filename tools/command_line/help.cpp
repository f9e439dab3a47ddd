#include "tools/command_line/help.hpp"

#include <algorithm>
#include <sstream>

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

}  // namespace

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

}  // namespace slalom::tools
