#pragma once

#include <chrono>
#include <cstdio>

#include "slalom/evaluation/evaluation.hpp"
#include "slalom/evaluation/grid_race.hpp"
#include "slalom/evaluation/lap.hpp"

namespace slalom::tools {

/// A line in a terminal that shows how a lap, a race or an evaluation goes, about twenty times a second.
/// Where the stream is no terminal, evaluations print a line for every tenth, laps and races print nothing.
class ProgressLine {
 public:
  explicit ProgressLine(std::FILE* stream);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(int lap, int laps, const evaluation::ControlStep& tick);
  void show(int race, int races, const evaluation::GridRaceStep& step);
  void show(const evaluation::EvaluationProgress& progress);
  /// Removes the line before other output.
  void clear();

 private:
  bool due();
  void write(const std::string& text);

  std::FILE* stream_;
  bool terminal_, shown_ = false;
  int tenth_ = -1;  ///< tenth of an evaluation that was printed last
  std::chrono::steady_clock::time_point next_{};
};

/// Laps and time left. Until the first lap is finished there is no estimate of it, and after the last lap
/// none is needed.
std::string evaluation_text(const evaluation::EvaluationProgress& progress);

}  // namespace slalom::tools
