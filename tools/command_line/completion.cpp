#include <algorithm>
#include <stdexcept>

#include "tools/command_line/description.hpp"

namespace slalom::tools {
namespace {

bool is_positional(const OptionDescription& option) {
  return option.name.rfind('-', 0) != 0;
}

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : " ") + word;
  return all;
}

/// The options whose values are known, as a pattern of the shell, and these values.
std::vector<std::pair<std::string, std::string>> known_values(const CompletionValues& values) {
  return {{"--course", joined(values.courses)},
          {"--config", joined(values.configurations)},
          {"--method|--methods", joined(values.methods)},
          {"--against", joined(values.methods) + " " + joined(values.configurations)}};
}

std::string bash_script(const std::vector<CommandDescription>& commands, const CompletionValues& values) {
  std::string names, options;
  for (const CommandDescription& command : commands) {
    names += " " + command.name;
    std::string own;
    for (const OptionDescription& option : command.options)
      if (!is_positional(option)) own += " " + option.name;
    options += "    " + command.name + ") options='--help" + own + "' ;;\n";
  }
  std::string script =
      "# Completion of slalom for bash.\n"
      "_slalom() {\n"
      "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} options=\n"
      "  COMPREPLY=()\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
      "    COMPREPLY=($(compgen -W '--help --version" +
      names +
      "' -- \"$word\"))\n"
      "    return\n"
      "  fi\n"
      "  case $before in\n";
  for (const auto& [option, known] : known_values(values))
    script += "    " + option + ") COMPREPLY=($(compgen -W '" + known + "' -- \"$word\")) ;;\n";
  script +=
      "  esac\n"
      "  case ${COMP_WORDS[1]} in\n" +
      options +
      "  esac\n"
      "  if [[ $word == -* ]]; then COMPREPLY=($(compgen -W \"$options\" -- \"$word\")); fi\n"
      "}\n"
      "complete -o default -F _slalom slalom\n";
  return script;
}

/// A text within single quotes of a zsh specification, whose own characters are escaped.
std::string zsh_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'')
      out += "'\\''";
    else if (c == '[' || c == ']' || c == ':' || c == '\\')
      out += std::string("\\") + c;
    else
      out += c == '\n' ? ' ' : c;
  }
  return out;
}

std::string zsh_values(const OptionDescription& option, const CompletionValues& values) {
  if (option.value.empty()) return "";
  for (const auto& [pattern, known] : known_values(values))
    if (("|" + pattern + "|").find("|" + option.name + "|") != std::string::npos)
      return ":value:(" + known + ")";
  return ":value:_files";
}

std::string zsh_script(const std::vector<CommandDescription>& commands, const CompletionValues& values) {
  std::string script =
      "#compdef slalom\n"
      "# Completion of slalom for zsh.\n"
      "_slalom() {\n"
      "  local -a commands\n"
      "  commands=(\n";
  for (const CommandDescription& command : commands)
    script += "    '" + command.name + ":" + zsh_text(command.summary) + "'\n";
  script +=
      "  )\n"
      "  if (( CURRENT == 2 )); then\n"
      "    _describe command commands\n"
      "    return\n"
      "  fi\n"
      "  local command=$words[2]\n"
      "  shift words\n"
      "  (( CURRENT-- ))\n"
      "  case $command in\n";
  for (const CommandDescription& command : commands) {
    script += "    " + command.name + ") _arguments '--help[Help]'";
    for (const OptionDescription& option : command.options)
      script += is_positional(option) ? " '*:" + zsh_text(option.name) + ":_files'"
                                      : " '*" + option.name + "[" + zsh_text(option.help) + "]" +
                                            zsh_values(option, values) + "'";
    script += " ;;\n";
  }
  script +=
      "  esac\n"
      "}\n"
      "_slalom \"$@\"\n";
  return script;
}

}  // namespace

std::string completion_script(const std::string& shell, const std::vector<CommandDescription>& commands,
                              const CompletionValues& values) {
  if (shell == "bash") return bash_script(commands, values);
  if (shell == "zsh") return zsh_script(commands, values);
  throw std::invalid_argument("shell: '" + shell + "' must be bash or zsh");
}

}  // namespace slalom::tools
