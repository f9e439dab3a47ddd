#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace slalom::tools {

/// Breaks a text into lines of at most `width` characters, the first of which begins after `used` of them.
/// Lines after the first begin with `indent` spaces, in lists (lines of the text that begin with two spaces)
/// with four. Commands stay whole.
std::string wrapped(const std::string& text, int width, int indent, int used);

/// Help that is as wide as the terminal: names of options in the first columns, what they do in the others.
class HelpFormatter : public CLI::Formatter {
 public:
  explicit HelpFormatter(int width) : width_(width) {}

  std::string make_description(const CLI::App* command) const override;
  std::string make_footer(const CLI::App* command) const override;
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_subcommand(const CLI::App* command) const override;

 private:
  std::string entry(const std::string& name, const std::string& text) const;

  int width_;
};

}  // namespace slalom::tools
