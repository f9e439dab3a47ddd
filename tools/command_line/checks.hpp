#pragma once

#include <string>
#include <vector>

namespace slalom::tools {

/// An option as the user gave it on the command line.
struct GivenOption {
  enum class Type { text, whole_number, natural_number, real_number, flag };
  std::string name;  ///< with its dashes; without any for a positional argument
  Type type = Type::text;
  bool positional = false;
  std::vector<std::string> values;
};

/// Rejects, before any work begins, what would fail or be lost later: an empty value, NaN, a negative number
/// where only natural ones make sense, an output file that cannot be written, is written twice or is also an
/// input. Throws CommandLineError, and IoError for a file that cannot be written.
void check_options(const std::vector<GivenOption>& options);

/// The exit status once all output is flushed: not 0 if standard output could not be written.
int after_output(int exit_status);

/// To be called first: makes output to a standard stream that is closed, or to a pipe that nobody reads any
/// more, an error in the writing call. Otherwise the next file that is opened would take the place of the
/// closed stream, or the system would end the program, with all that it has not yet written.
void guard_standard_streams();

}  // namespace slalom::tools
