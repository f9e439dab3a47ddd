#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace slalom::testing {

/// The folder of golden data `set` ("controller/softmax", ...) below SLALOM_GOLDEN_DIR, read when the test
/// runs; empty if the variable is unset or the folder does not exist.
inline std::filesystem::path golden_folder(const char* set) {
  const char* root = std::getenv("SLALOM_GOLDEN_DIR");
  if (!root || !*root) return {};
  const auto folder = std::filesystem::path(root) / set;
  return std::filesystem::exists(folder) ? folder : std::filesystem::path{};
}

}  // namespace slalom::testing

/// Declares `folder`; skips the test with a message where the golden data are absent.
#define SLALOM_GOLDEN_FOLDER(folder, set)                  \
  const auto folder = slalom::testing::golden_folder(set); \
  if (folder.empty()) GTEST_SKIP() << "no golden data: set SLALOM_GOLDEN_DIR to a folder that has " set
