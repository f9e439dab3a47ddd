#include "slalom/evaluation/result_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

#include "evaluation/system_files.hpp"
#include "slalom/core/error.hpp"

namespace slalom::evaluation {
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

/// Makes the entries of a folder survive a loss of power.
void sync_folder(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) detail::throw_system(folder, "cannot be opened");
  const int failed = ::fsync(descriptor);
  ::close(descriptor);
  if (failed != 0 && errno != EINVAL)
    detail::throw_system(folder, "cannot be written");  // EINVAL: cannot be synced
}

}  // namespace

namespace detail {

void throw_system(const std::filesystem::path& file, const char* what) {
  throw IoError(file.string(), 0, std::string(what) + ": " + std::generic_category().message(errno));
}

void write_all(int descriptor, const std::string& text, const std::filesystem::path& file) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = ::write(descriptor, text.data() + done, text.size() - done);
    if (written < 0 && errno != EINTR) throw_system(file, "cannot be written");
    if (written > 0) done += static_cast<std::size_t>(written);
  }
}

}  // namespace detail

FolderLock::FolderLock(const std::filesystem::path& folder) : file_(folder / "lock") {
  const auto fail = [this] {
    const int error = errno;
    if (descriptor_ >= 0) ::close(descriptor_);
    throw IoError(file_.string(), 0,
                  std::string("cannot be locked: ") + std::generic_category().message(error));
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

void replace_file(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path next = file.string() + ".new";
  const int descriptor = ::open(next.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor < 0) detail::throw_system(next, "cannot be written");
  try {
    detail::write_all(descriptor, text, next);
    if (::fsync(descriptor) != 0) detail::throw_system(next, "cannot be written");
  } catch (...) {
    ::close(descriptor);
    throw;
  }
  ::close(descriptor);
  if (::rename(next.c_str(), file.c_str()) != 0) detail::throw_system(file, "cannot be written");
  sync_folder(file.parent_path());
}

}  // namespace slalom::evaluation
