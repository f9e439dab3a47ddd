#pragma once

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>
#include <stdexcept>
#include <string>
#include <vector>

namespace slalom_ros_test {

/// A program that runs until this ends.
class Process {
 public:
  /// Throws std::runtime_error if the program cannot be started.
  explicit Process(const std::vector<std::string>& words) {
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    if (posix_spawn(&id_, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0)
      throw std::runtime_error(words[0] + ": cannot be started");
  }
  ~Process() { end(SIGINT); }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Sends a signal and waits for the end.
  void end(int signal) {
    if (id_ <= 0) return;
    ::kill(id_, signal);
    waitpid(id_, nullptr, 0);
    id_ = 0;
  }

 private:
  pid_t id_ = 0;
};

}  // namespace slalom_ros_test
