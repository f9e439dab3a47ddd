#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/temporary_folder.hpp"
#include "tools/program.hpp"

namespace slalom::testing {

/// Base of tests that run the program in a folder of their own.
class ProgramTest : public TemporaryFolder {
 protected:
  testing::Run program(const std::string& arguments) const {
    return run_program(arguments, folder_.string());
  }
  /// The program ends with a status other than 0 and says each of these words.
  void expect_refused(const std::string& arguments, const std::vector<std::string>& says) const {
    const testing::Run run = program(arguments);
    EXPECT_NE(run.status, 0) << arguments;
    for (const auto& word : says)
      EXPECT_NE(run.output.find(word), std::string::npos) << arguments << ": " << run.output;
  }
};

}  // namespace slalom::testing
