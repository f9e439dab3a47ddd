#pragma once

#include <vector>

#include "tools/command_line/command.hpp"

/// The sub-commands of the program. `declare_<name>` is in `<name>_command.cpp`.
namespace slalom::tools {

void declare_bench(Command& command);
void declare_compare(Command& command);
void declare_drive(Command& command);
void declare_eval(Command& command);
void declare_explain(Command& command);
void declare_hardware(Command& command);
void declare_identify(Command& command);
void declare_options(Command& command);
void declare_replay(Command& command);
void declare_reproduce(Command& command);
void declare_track(Command& command);
void declare_tune(Command& command);
void declare_view(Command& command);

/// All of them, in alphabetical order.
const std::vector<CommandEntry>& all_commands();

}  // namespace slalom::tools
