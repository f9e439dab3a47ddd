#pragma once

namespace CLI {
class App;
}

/// What holds for every command alike.
namespace slalom::tools {

/// Before any work begins: no value is empty or NaN, no seed negative; every file to be written can be, and
/// none is written twice or is one that is read. Throws CLI::ValidationError, IoError.
void check_command_line(const CLI::App& command);

/// The exit status once all that was printed is out: not 0 where standard output could not take it.
int after_output(int exit_status);

}  // namespace slalom::tools
