#include "tools/commands/commands.hpp"

namespace slalom::tools {

const std::vector<CommandEntry>& all_commands() {
  static const std::vector<CommandEntry> commands = {
      {"bench", declare_bench},     {"compare", declare_compare},   {"completion", declare_completion},
      {"course", declare_course},   {"drive", declare_drive},       {"eval", declare_eval},
      {"explain", declare_explain}, {"hardware", declare_hardware}, {"identify", declare_identify},
      {"manual", declare_manual},   {"navigate", declare_navigate}, {"options", declare_options},
      {"race", declare_race},       {"replay", declare_replay},     {"reproduce", declare_reproduce},
      {"soak", declare_soak},       {"track", declare_track},       {"tune", declare_tune},
      {"view", declare_view}};
  return commands;
}

}  // namespace slalom::tools
