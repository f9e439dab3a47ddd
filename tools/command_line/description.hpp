#pragma once

#include <string>
#include <vector>

#include "tools/command_line/command.hpp"

namespace slalom::tools {

/// A command's declaration of an option.
struct OptionDescription {
  std::string name;    ///< with its dashes; without any for a positional argument
  std::string help;    ///< one sentence or more, without a full stop at the end
  std::string value;   ///< kind of the value: TEXT, INT, ...; empty for a flag
  std::string preset;  ///< default value; empty if none is shown
  bool is_required = false;
};

/// The declaration of a command.
struct CommandDescription {
  std::string name, summary, footer;
  std::vector<OptionDescription> options;  ///< in the order of their declaration, without --help
};

/// Declares commands without running them.
std::vector<CommandDescription> describe_commands(const std::vector<CommandEntry>& commands);

/// The script that completes commands and options in a shell: bash or zsh. Values of --course, --config,
/// --method and --methods are completed from `courses`, `configurations` and `methods`, others as file names.
/// Throws std::invalid_argument for another shell.
struct CompletionValues {
  std::vector<std::string> courses, configurations, methods;
};
std::string completion_script(const std::string& shell, const std::vector<CommandDescription>& commands,
                              const CompletionValues& values);

/// A page of the manual in the format of man(7).
struct ManualPage {
  std::string file;  ///< name of the file, such as slalom-drive.1
  std::string text;
};
/// The page of the program, and one of each command.
std::vector<ManualPage> manual_pages(const std::vector<CommandDescription>& commands);

}  // namespace slalom::tools
