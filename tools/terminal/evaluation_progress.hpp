#pragma once

#include <string>

#include "slalom/evaluation/evaluation.hpp"

namespace slalom::tools {

/// How far an evaluation is, on standard error: a bar with the time left in a terminal; elsewhere a line for
/// every tenth.
class EvaluationProgressBar {
 public:
  /// `title` stands before the bar.
  explicit EvaluationProgressBar(std::string title = "");
  ~EvaluationProgressBar();
  EvaluationProgressBar(const EvaluationProgressBar&) = delete;
  EvaluationProgressBar& operator=(const EvaluationProgressBar&) = delete;

  void show(const evaluation::EvaluationProgress& progress);

 private:
  std::string title_;
  bool terminal_;
  int tenth_ = -1;
};

}  // namespace slalom::tools
