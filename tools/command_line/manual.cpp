#include <algorithm>
#include <cctype>

#include "slalom/core/version.hpp"
#include "tools/command_line/description.hpp"

namespace slalom::tools {
namespace {

/// A text in which troff sees no requests: backslashes and hyphens are escaped, and a leading dot is guarded.
std::string escaped(const std::string& text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
    line_begins = c == '\n';
  }
  return out;
}

std::string heading(const std::string& name, const std::string& summary) {
  std::string upper = name;
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return ".TH " + upper + " 1 \"\" \"slalom " + version() + "\" \"Slalom\"\n.SH NAME\n" + escaped(name) +
         " \\- " + escaped(summary) + "\n";
}

std::string command_page(const CommandDescription& command) {
  std::string text = heading("slalom-" + command.name, command.summary) + ".SH SYNOPSIS\n.B slalom " +
                     escaped(command.name) + "\n[options]";
  for (const OptionDescription& option : command.options)
    if (option.name.rfind('-', 0) != 0)
      text += option.is_required ? " " + escaped(option.name) : " [" + escaped(option.name) + "]";
  text += "\n.SH OPTIONS\n";
  for (const OptionDescription& option : command.options) {
    text += ".TP\n.B " + escaped(option.name);
    if (!option.value.empty()) text += " \\fI" + escaped(option.value) + "\\fR";
    text += "\n" + escaped(option.help);
    if (!option.preset.empty()) text += " (default: " + escaped(option.preset) + ")";
    text += ".\n";
  }
  if (!command.footer.empty()) text += ".SH NOTES\n.nf\n" + escaped(command.footer) + "\n.fi\n";
  return text + ".SH SEE ALSO\n.BR slalom (1)\n";
}

}  // namespace

std::vector<ManualPage> manual_pages(const std::vector<CommandDescription>& commands) {
  std::string text = heading("slalom", "real-time sampling-based stochastic optimal control") +
                     ".SH SYNOPSIS\n.B slalom\n.I COMMAND\n[options]\n.SH COMMANDS\n";
  std::vector<ManualPage> pages;
  for (const CommandDescription& command : commands) {
    text += ".TP\n.BR slalom\\-" + escaped(command.name) + " (1)\n" + escaped(command.summary) + ".\n";
    pages.push_back({"slalom-" + command.name + ".1", command_page(command)});
  }
  text +=
      ".SH EXIT STATUS\n.TP\n0\nSuccess.\n.TP\n1\nThe command failed.\n.TP\n2\nThe command line is "
      "invalid.\n";
  pages.insert(pages.begin(), {"slalom.1", text});
  return pages;
}

}  // namespace slalom::tools
