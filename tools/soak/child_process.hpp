#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace slalom::tools {

/// This program, run again in a process of its own with other arguments. What it prints goes to a file.
class ChildProcess {
 public:
  /// Throws std::system_error if the process cannot be started.
  ChildProcess(const std::vector<std::string>& arguments, const std::filesystem::path& printed);
  /// Kills it if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void send(int signal) noexcept;
  /// Whether it has ended.
  bool ended() noexcept;
  /// Waits for its end. Returns its exit status, or 128 and the number of the signal that ended it.
  int wait() noexcept;

 private:
  pid_t process_ = -1;
  int status_ = 0;
  bool ended_ = false;
};

}  // namespace slalom::tools
