#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tools/program.hpp"

namespace slalom::testing {

inline std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Tests that run the program in a folder of their own.
class ScratchFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              (std::string("slalom_") + test->test_suite_name() + "." + test->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

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

  std::filesystem::path folder_;
};

}  // namespace slalom::testing
