#include "evaluation/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "slalom/core/error.hpp"

namespace slalom::evaluation::detail {
namespace {

std::string holder_of(int descriptor) {
  char text[300];
  const ssize_t size = ::pread(descriptor, text, sizeof text, 0);
  return size > 0 ? std::string(text, static_cast<std::size_t>(size)) : "another process";
}

std::string this_process() {
  char host[256] = "";
  ::gethostname(host, sizeof host - 1);
  return "process " + std::to_string(::getpid()) + " on " + host;
}

/// Whether the open file is still the one of this name: its holder removes it before it unlocks it.
bool is_file(int descriptor, const std::filesystem::path& file) {
  struct stat opened {};
  struct stat named {};
  return ::fstat(descriptor, &opened) == 0 && ::stat(file.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder) : file_(folder / "lock") {
  const auto fail = [this] {
    const int error = errno;
    if (descriptor_ >= 0) ::close(descriptor_);
    throw IoError(file_.string(), 0, std::string("cannot be locked: ") + std::strerror(error));
  };
  for (;;) {
    descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor_ < 0) fail();
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      if (errno != EWOULDBLOCK) fail();
      const std::string holder = holder_of(descriptor_);
      ::close(descriptor_);
      throw IoError(file_.parent_path().string(), 0,
                    "is in use by " + holder + ": wait until it has ended, or use another folder");
    }
    if (is_file(descriptor_, file_)) break;
    ::close(descriptor_);
  }
  const std::string holder = this_process();
  if (::ftruncate(descriptor_, 0) != 0 ||
      ::pwrite(descriptor_, holder.data(), holder.size(), 0) != static_cast<ssize_t>(holder.size()))
    fail();
}

FolderLock::~FolderLock() {
  ::unlink(file_.c_str());
  ::close(descriptor_);
}

}  // namespace slalom::evaluation::detail
