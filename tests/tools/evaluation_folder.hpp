#pragma once

#include <signal.h>

#include "slalom/evaluation/evaluation.hpp"
#include "tools/program_test.hpp"

/// Tests that run evaluations in a folder of their own.
namespace slalom::testing {

namespace fs = std::filesystem;

inline std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> parts;
  std::istringstream stream(line);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

/// laps.csv without the columns that hold wall-clock times.
inline std::string repeatable(const fs::path& file) {
  std::istringstream lines(content(file));
  std::string line, text;
  std::vector<bool> kept;
  while (std::getline(lines, line)) {
    const auto parts = cells(line);
    if (kept.empty())
      for (const auto& name : parts)
        kept.push_back(name != "checksum" && name != "wall_time" && name.rfind("solve_", 0) != 0);
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (kept.at(i)) text += parts[i] + ",";
    text += "\n";
  }
  return text;
}

/// Writes these settings of an evaluation, with their checksum.
inline void write_settings(const fs::path& folder, const std::string& settings) {
  std::ofstream(folder / "settings.json") << evaluation::with_checksum(settings);
}

inline std::size_t count_lines(const fs::path& file) {
  const std::string text = content(file);
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

class EvaluationFolder : public ProgramTest {
 protected:
  /// Starts the program, kills it after so many milliseconds; true if that is what ended it.
  bool kill_after(const std::string& arguments, int milliseconds) const {
    const std::string command = "cd '" + folder_.string() + "' && exec '" SLALOM_PROGRAM "' " + arguments;
    const pid_t child = fork();
    if (child == 0) {
      const int nothing = open("/dev/null", O_WRONLY);
      dup2(nothing, 1);
      dup2(nothing, 2);
      execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
      _exit(127);
    }
    usleep(static_cast<useconds_t>(milliseconds) * 1000);
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status);
  }
};

}  // namespace slalom::testing
