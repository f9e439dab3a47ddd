#include "slalom/evaluation/result_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <system_error>

#include "slalom/core/error.hpp"

namespace slalom::evaluation {

void throw_system_error(const std::filesystem::path& file, const std::string& what) {
  throw IoError(file.string(), 0, what + ": " + std::generic_category().message(errno));
}

FolderLock::FolderLock(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw IoError(folder.string(), 0, "cannot create the folder: " + error.message());
  const std::filesystem::path file = folder / "lock";
  descriptor_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) throw_system_error(file, "cannot be locked");
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  const bool held = errno == EWOULDBLOCK;
  const int reason = errno;
  ::close(descriptor_);
  errno = reason;
  if (!held) throw_system_error(file, "cannot be locked");
  throw IoError(folder.string(), 0,
                "is in use by another process: wait until it has ended, or use another folder");
}

FolderLock::~FolderLock() {
  ::close(descriptor_);
}

void replace_file(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path next = file.string() + ".new";
  std::ofstream stream(next, std::ios::binary);
  stream << text << std::flush;
  if (!stream) throw_system_error(next, "cannot be written");
  stream.close();
  if (::rename(next.c_str(), file.c_str()) != 0) throw_system_error(file, "cannot be written");
}

}  // namespace slalom::evaluation
