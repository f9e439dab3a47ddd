#pragma once

#include <filesystem>

namespace slalom::evaluation::detail {

/// Keeps other processes, and other stores of this one, out of a folder while it exists. The lock is a file
/// that the system unlocks when its holder ends, however it ends.
class FolderLock {
 public:
  /// Throws IoError that names the holder if there is one, and if the file cannot be made.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace slalom::evaluation::detail
