#include "tools/commands/commands.hpp"

namespace slalom::tools {

const std::vector<CommandEntry>& all_commands() {
  static const std::vector<CommandEntry> commands = {
      {"bench", declare_bench},       {"compare", declare_compare},   {"course", declare_course},
      {"drive", declare_drive},       {"eval", declare_eval},         {"explain", declare_explain},
      {"identify", declare_identify}, {"navigate", declare_navigate}, {"options", declare_options},
      {"race", declare_race},         {"replay", declare_replay},     {"reproduce", declare_reproduce},
      {"track", declare_track},       {"view", declare_view}};
  return commands;
}

}  // namespace slalom::tools
