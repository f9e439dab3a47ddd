#pragma once

#include <filesystem>
#include <string>

/// Folders of results that survive a kill, a full disk and a second process.
namespace slalom::evaluation {

/// Keeps other processes, and other locks of this one, out of a folder while it exists. The lock is the file
/// `lock` of the folder. The system releases it when its holder ends, however it ends.
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

/// Replaces a file atomically, or makes it: it has either its old bytes or all of `text`. Once this returns,
/// it survives a loss of power. The new bytes are first written to `file` + ".new". Throws IoError if that or
/// the file cannot be written.
void replace_file(const std::filesystem::path& file, const std::string& text);

}  // namespace slalom::evaluation
