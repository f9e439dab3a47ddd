#pragma once

#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "slalom/evaluation/grid_race.hpp"
#include "slalom/evaluation/lap.hpp"

namespace slalom::tools {

/// A line in a terminal that shows how a lap or a race goes, about twenty times a second. Silent where the
/// stream is none.
class ProgressLine {
 public:
  explicit ProgressLine(std::FILE* stream);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(int lap, int laps, const evaluation::ControlStep& tick);
  void show(int race, int races, const evaluation::GridRaceStep& step);
  /// Removes the line before other output.
  void clear();

 private:
  bool due();
  void write(const std::string& title, double progress, const std::vector<std::string>& parts);

  std::FILE* stream_;
  bool active_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point next_{};
};

}  // namespace slalom::tools
