#pragma once

#include <string>
#include <vector>

namespace slalom::tools {

/// An option as the user gave it on the command line.
struct GivenOption {
  std::string name;  ///< with its dashes; a positional argument has none
  bool positional = false;
  std::vector<std::string> values;
};

/// Rejects, before any work begins, an output file that cannot be written, is written twice or is also an
/// input. Throws CommandLineError, and IoError for a file that cannot be written.
void check_files(const std::vector<GivenOption>& options);

/// The exit status once all output is flushed: not 0 if standard output could not be written.
int after_output(int exit_status);

/// Must be called first. Makes output to a standard stream that is closed, or to a pipe that nobody reads any
/// more, an error in the writing call. Otherwise the next file that is opened would take the place of the
/// closed stream, or the system would end the program, with all that it has not yet written.
void guard_standard_streams();

}  // namespace slalom::tools
