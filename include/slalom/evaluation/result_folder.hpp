#pragma once

#include <filesystem>
#include <string>

/// Folders of results that survive a kill and a second process.
namespace slalom::evaluation {

/// Keeps other processes, and other locks of this one, out of a folder while it exists. The lock is the file
/// `lock` of the folder. The system releases it when its holder ends, however it ends.
class FolderLock {
 public:
  /// Makes the folder if there is none. Throws IoError if somebody holds the lock, and if folder or file
  /// cannot be made.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

/// Replaces a file, or makes it: other processes see either its old bytes or all of `text`, which is first
/// written to `file` + ".new". Throws IoError if that or the file cannot be written.
void replace_file(const std::filesystem::path& file, const std::string& text);

/// Throws the IoError that names `file`, `what` and the meaning of errno.
[[noreturn]] void throw_system_error(const std::filesystem::path& file, const std::string& what);

}  // namespace slalom::evaluation
