// The program slalom: one sub-command per job.
#include "tools/commands/commands.hpp"

int main(int argc, char** argv) {
  return slalom::tools::run_command_line(argc, argv, slalom::tools::all_commands());
}
