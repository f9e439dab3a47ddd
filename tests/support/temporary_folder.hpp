#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

namespace slalom::testing {

/// The bytes of a file; empty if it cannot be read.
inline std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// A folder of its own, removed with all that is in it when the object ends.
class ScopedFolder {
 public:
  ScopedFolder() {
    std::random_device entropy;
    path_ = std::filesystem::temp_directory_path() /
            ("slalom_test_" + std::to_string(entropy()) + std::to_string(entropy()));
    std::filesystem::create_directories(path_);
  }
  ~ScopedFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScopedFolder(const ScopedFolder&) = delete;
  ScopedFolder& operator=(const ScopedFolder&) = delete;

  const std::filesystem::path& path() const noexcept { return path_; }

  /// Writes a file in it and returns its path.
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// Base of tests that use a folder of their own.
class TemporaryFolder : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    return scoped_.write(name, text);
  }

 private:
  ScopedFolder scoped_;

 protected:
  const std::filesystem::path& folder_ = scoped_.path();
};

}  // namespace slalom::testing
