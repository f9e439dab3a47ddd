#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>

namespace slalom::testing {

/// A test with a folder of its own that is removed afterwards.
class TemporaryFolder : public ::testing::Test {
 protected:
  TemporaryFolder() {
    std::random_device entropy;
    folder_ = std::filesystem::temp_directory_path() /
              ("slalom_test_" + std::to_string(entropy()) + std::to_string(entropy()));
    std::filesystem::create_directories(folder_);
  }
  ~TemporaryFolder() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
  }

  std::filesystem::path folder_;
};

}  // namespace slalom::testing
