#include "tools/command_line/checks.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <system_error>

#include "slalom/core/error.hpp"
#include "tools/command_line/command.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;

/// Options that name a file to be written; `file` is positional.
constexpr const char* outputs[] = {"--json", "--record", "--plot", "file"};

/// A canonical path, equal for equal files; empty for devices and pipes, which can be named more than once.
std::string canonical_path(const std::string& file) {
  std::error_code unknown;
  const auto status = fs::status(file, unknown);
  if (fs::exists(status) && !fs::is_regular_file(status)) return {};
  const fs::path path = fs::weakly_canonical(fs::absolute(file, unknown), unknown);
  return unknown ? file : path.string();
}

/// Fails now instead of after hours of work. Leaves no file behind.
void require_writable(const std::string& file) {
  std::error_code unknown;
  const auto status = fs::status(file, unknown);
  if (fs::is_directory(status)) throw IoError(file, 0, "cannot be written: is a folder");
  // Opening a pipe would block until somebody reads it.
  if (fs::exists(status) && !fs::is_regular_file(status)) return;
  const bool there = fs::exists(status);
  const int descriptor =
      ::open(file.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK | (there ? 0 : O_CREAT | O_EXCL), 0666);
  if (descriptor < 0)
    throw IoError(file, 0, std::string("cannot be written: ") + std::generic_category().message(errno));
  ::close(descriptor);
  if (!there) ::unlink(file.c_str());
}

void check_output(const std::string& name, const std::string& file) {
  if (file == "-") throw CommandLineError(name, "must be a file; only --json accepts - for standard output");
  std::string extension = fs::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (name == "--plot" && !extension.empty() && extension != ".png" && extension != ".svg" &&
      extension != ".pdf")
    throw CommandLineError(name, file, "must end in .png, .svg or .pdf");
  if (name == "--record" && extension != ".mcap") throw CommandLineError(name, file, "must end in .mcap");
  require_writable(file);
}

}  // namespace

void check_files(const std::vector<GivenOption>& options) {
  std::map<std::string, std::string> taken;  // options by the paths of their files
  for (const GivenOption& option : options)
    for (const std::string& value : option.values) {
      const bool input = (option.positional && option.name != "file") || option.name == "--config";
      if (input && fs::is_regular_file(value)) taken.emplace(canonical_path(value), option.name);
    }
  for (const char* name : outputs)
    for (const GivenOption& option : options) {
      if (option.name != name) continue;
      const std::string& file = option.values.back();
      if (file == "-" && option.name == "--json") continue;
      check_output(option.name, file);
      const std::string path = canonical_path(file);
      if (path.empty()) continue;
      const auto [other, is_new] = taken.emplace(path, option.name);
      if (!is_new) throw CommandLineError(other->second + ", " + option.name, "both name the file " + file);
    }
}

void guard_standard_streams() {
  std::signal(SIGPIPE, SIG_IGN);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) != -1) continue;
    // The lowest free descriptor, so that of this stream. It cannot be written to.
    if (::open("/dev/null", O_RDONLY) < 0) throw std::runtime_error("/dev/null: cannot be opened");
  }
}

int after_output(int exit_status) {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout) return exit_status;
  std::cerr << "slalom: standard output: cannot be written\n";
  return exit_status == 0 ? 1 : exit_status;
}

}  // namespace slalom::tools
