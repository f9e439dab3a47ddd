#pragma once

#include "tools/command_line/command.hpp"

/// The sub-commands of the program. tools/main.cpp lists them; `declare_<name>` is in `<name>_command.cpp`.
namespace slalom::tools {

void declare_bench(Subcommand& command);
void declare_compare(Subcommand& command);
void declare_course(Subcommand& command);
void declare_drive(Subcommand& command);
void declare_eval(Subcommand& command);
void declare_explain(Subcommand& command);
void declare_export(Subcommand& command);
void declare_identify(Subcommand& command);
void declare_navigate(Subcommand& command);
void declare_options(Subcommand& command);
void declare_race(Subcommand& command);
void declare_racing_benchmark(Subcommand& command);
void declare_replay(Subcommand& command);
void declare_reproduce(Subcommand& command);
void declare_track(Subcommand& command);
void declare_tune(Subcommand& command);
void declare_view(Subcommand& command);

/// Becomes a process of Python that calls `main` of a module of the package that was built or installed with
/// this program; it has the words of this command line after the command's name. The interpreter is
/// $SLALOM_PYTHON, or else that of the system. Throws IoError if it cannot be started.
[[noreturn]] void become_python(const std::string& module);

}  // namespace slalom::tools
