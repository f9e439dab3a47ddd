#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/temporary_folder.hpp"

namespace slalom::testing {

/// The output of a run of the program, and its exit status.
struct Run {
  int status = -1;
  std::string output;  ///< standard output and standard error
};

/// Runs what a shell makes of `words`, in `folder`.
inline Run run_shell(const std::string& words, const std::string& folder = ".") {
  const std::string command = "cd '" + folder + "' && ( " + words + " ) 2>&1";
  // NOLINTNEXTLINE(cert-env33-c): the tests of the command line need a shell.
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) throw std::runtime_error("no shell");
  Run run;
  std::array<char, 4096> buffer{};
  while (const std::size_t count = fread(buffer.data(), 1, buffer.size(), pipe))
    run.output.append(buffer.data(), count);
  const int ended = pclose(pipe);
  run.status = WIFEXITED(ended) ? WEXITSTATUS(ended) : -1;
  return run;
}

/// Runs `slalom` with arguments as a shell reads them, in `folder`.
inline Run run_program(const std::string& arguments, const std::string& folder = ".") {
  return run_shell("'" SLALOM_PROGRAM "' " + arguments, folder);
}

inline bool contains(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

/// Expects that a text has each of these words.
inline void expect_says(const std::string& text, const std::vector<std::string>& says) {
  for (const std::string& words : says) EXPECT_TRUE(contains(text, words)) << words << " in " << text;
}

/// Base of tests that run the program in a folder of their own.
class ProgramTest : public TemporaryFolder {
 protected:
  testing::Run program(const std::string& arguments) const {
    return run_program(arguments, folder_.string());
  }
  /// The program ends with status 0; returns what it says.
  std::string succeed(const std::string& arguments) const {
    const testing::Run run = program(arguments);
    EXPECT_EQ(run.status, 0) << arguments << ": " << run.output;
    return run.output;
  }
  /// The program ends with this status, or with any but 0, and says each of these words.
  void expect_refused(const std::string& arguments, const std::vector<std::string>& says,
                      std::optional<int> status = {}) const {
    const testing::Run run = program(arguments);
    EXPECT_TRUE(status ? run.status == *status : run.status != 0) << arguments << ": " << run.status;
    expect_says(run.output, says);
  }
  /// The JSON in a file of the folder.
  nlohmann::json result(const std::string& file) const {
    return nlohmann::json::parse(content(folder_ / file));
  }
};

}  // namespace slalom::testing
