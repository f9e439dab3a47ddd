#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace slalom::tools {

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

}  // namespace slalom::tools
