#include "tools/terminal/command_line.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>

#include "slalom/core/error.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;

/// The options that name a file to be written.
constexpr const char* outputs[] = {"--json", "--record", "--plot", "--html"};

void check_value(const CLI::Option& option, const std::string& value) {
  const std::string name = option.get_name(), type = option.get_type_name();
  // Mostly a shell's variable that is not set: what it should have named would be lost without a word.
  if (value.empty()) throw CLI::ValidationError(name, "the value is empty");
  if (type.rfind("UINT", 0) == 0) {
    errno = 0;
    std::strtoull(value.c_str(), nullptr, 0);
    if (value.find('-') != std::string::npos || errno == ERANGE)
      throw CLI::ValidationError(name, value + " must be a whole number from 0 to 2^64 - 1");
  }
  if (type.rfind("FLOAT", 0) == 0 && std::isnan(std::strtod(value.c_str(), nullptr)))
    throw CLI::ValidationError(name, value + " must be a number");
}

struct NamedFile {
  std::string option, file;
};

/// The same file has the same place, however it is written; "" for devices and pipes, which take anything.
std::string place_of(const std::string& file) {
  std::error_code unknown;
  const auto status = fs::status(file, unknown);
  if (fs::exists(status) && !fs::is_regular_file(status)) return {};
  const fs::path place = fs::weakly_canonical(fs::absolute(file, unknown), unknown);
  return unknown ? file : place.string();
}

void check_apart(const std::vector<NamedFile>& files) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const std::string place = place_of(files[i].file);
      if (!place.empty() && place == place_of(files[j].file))
        throw CLI::ValidationError(files[j].option + ", " + files[i].option,
                                   "both name the file " + files[i].file);
    }
  }
}

/// Finds out now what would else be found out after hours. Leaves nothing behind.
void require_writable(const std::string& file) {
  std::error_code unknown;
  const auto status = fs::status(file, unknown);
  if (fs::is_directory(status)) throw IoError(file, 0, "cannot be written: is a folder");
  // Opening a pipe would wait for its reader.
  if (fs::exists(status) && !fs::is_regular_file(status)) return;
  const bool there = fs::exists(status);
  const int descriptor =
      ::open(file.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK | (there ? 0 : O_CREAT | O_EXCL), 0666);
  if (descriptor < 0) {
    const int why = errno;
    // Another process of ours (mpirun) is trying it too.
    if (why == (there ? ENOENT : EEXIST)) return;
    throw IoError(file, 0, std::string("cannot be written: ") + std::strerror(why));
  }
  ::close(descriptor);
  if (!there) ::unlink(file.c_str());
}

void check_output(const std::string& name, const std::string& file) {
  if (file == "-") throw CLI::ValidationError(name, "only --json can go to standard output");
  std::string extension = fs::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (name == "--plot" && !extension.empty() && extension != ".png")
    throw CLI::ValidationError(name, file + " must end in .png: pictures are PNG");
  require_writable(file);
}

}  // namespace

void check_command_line(const CLI::App& command) {
  std::vector<NamedFile> files;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& value : option->results()) {
      if (option->get_expected_max() > 0) check_value(*option, value);
      if (option->get_positional() || option->get_name() == "--config")
        if (fs::is_regular_file(value)) files.push_back({option->get_name(), value});
    }
  }
  for (const char* name : outputs) {
    const CLI::Option* option = command.get_option_no_throw(name);
    if (option == nullptr || option->count() == 0) continue;
    const std::string file = option->results().back();
    if (file == "-" && name == std::string("--json")) continue;
    check_output(name, file);
    files.push_back({name, file});
    check_apart(files);
  }
}

int after_output(int exit_status) {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout) return exit_status;
  std::cerr << "slalom: standard output: cannot be written\n";
  return exit_status == 0 ? 1 : exit_status;
}

}  // namespace slalom::tools
