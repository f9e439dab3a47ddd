#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <vector>

#include "support/temporary_folder.hpp"

namespace slalom::testing {

/// The output of a run of the program, and its exit status.
struct Run {
  int status = -1;
  std::string output;  ///< standard output and standard error
};

/// Runs what a shell makes of `words`, in `folder`.
inline Run run_shell(const std::string& words, const std::string& folder = ".") {
  const std::string command = "cd '" + folder + "' && ( " + words + " ) 2>&1";
  // NOLINTNEXTLINE(cert-env33-c): the tests of the command line need a shell.
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) throw std::runtime_error("no shell");
  Run run;
  std::array<char, 4096> buffer{};
  while (const std::size_t count = fread(buffer.data(), 1, buffer.size(), pipe))
    run.output.append(buffer.data(), count);
  const int ended = pclose(pipe);
  run.status = WIFEXITED(ended) ? WEXITSTATUS(ended) : -1;
  return run;
}

/// Runs `slalom` with arguments as a shell reads them, in `folder`.
inline Run run_program(const std::string& arguments, const std::string& folder = ".") {
  return run_shell("'" SLALOM_PROGRAM "' " + arguments, folder);
}

/// What the program writes as `name` with these arguments, made once for all tests. Tests change only copies.
inline std::filesystem::path made_once(const std::string& name, const std::string& arguments) {
  const auto built = std::filesystem::last_write_time(SLALOM_PROGRAM).time_since_epoch().count();
  const auto version = std::hash<std::string>{}(arguments + std::to_string(built));
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("slalom_made_" + std::to_string(version));
  std::filesystem::create_directories(folder);
  const int lock = open((folder / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  flock(lock, LOCK_EX);
  if (!std::filesystem::exists(folder / "made")) {
    const Run run = run_program(arguments, folder.string());
    if (run.status != 0) throw std::runtime_error(arguments + ": " + run.output);
    std::ofstream(folder / "made") << arguments;
  }
  close(lock);
  return folder / name;
}

/// A lap with everything recorded.
inline std::filesystem::path recorded_lap() {
  return made_once("lap.mcap", "drive --course wren --obstacles 2 --seed 3 --record-all --record lap.mcap");
}
/// A lap with the usual part of it recorded.
inline std::filesystem::path small_recording() {
  return made_once("lap.mcap", "drive --course wren --method mppi --set samples=32 --record lap.mcap");
}
/// An evaluation of one lap.
inline std::filesystem::path evaluated_lap() {
  return made_once("ev", "eval --course " SLALOM_COURSES
                         "/wren --methods mppi --scenario pt --laps 1 --config default_kinematic --set "
                         "mppi.samples=48 --out ev");
}

inline bool contains(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

/// Expects that a text has each of these words.
inline void expect_says(const std::string& text, const std::vector<std::string>& says) {
  for (const std::string& words : says) EXPECT_TRUE(contains(text, words)) << words << " in " << text;
}

/// Base of tests that run the program in a folder of their own.
class ProgramTest : public TemporaryFolder {
 protected:
  testing::Run program(const std::string& arguments) const {
    return run_program(arguments, folder_.string());
  }
  /// The program ends with status 0; returns what it says.
  std::string succeed(const std::string& arguments) const {
    const testing::Run run = program(arguments);
    EXPECT_EQ(run.status, 0) << arguments << ": " << run.output;
    return run.output;
  }
  /// The program ends with this status, or with any but 0, and says each of these words.
  void expect_refused(const std::string& arguments, const std::vector<std::string>& says,
                      std::optional<int> status = {}) const {
    const testing::Run run = program(arguments);
    EXPECT_TRUE(status ? run.status == *status : run.status != 0) << arguments << ": " << run.status;
    expect_says(run.output, says);
  }
  /// The JSON in a file of the folder.
  nlohmann::json result(const std::string& file) const {
    return nlohmann::json::parse(content(folder_ / file));
  }
};

}  // namespace slalom::testing

namespace slalom::tools {
namespace fs = std::filesystem;
using namespace testing;
using nlohmann::json;
}  // namespace slalom::tools
