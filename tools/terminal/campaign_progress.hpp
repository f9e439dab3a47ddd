#pragma once

#include <string>

#include "slalom/evaluation/evaluation.hpp"

namespace slalom::tools {

/// How far an evaluation is, on standard error: a bar with the time left in a terminal; elsewhere a line for
/// every tenth.
class CampaignProgressBar {
 public:
  /// `title` stands before the bar.
  explicit CampaignProgressBar(std::string title = "");
  ~CampaignProgressBar();
  CampaignProgressBar(const CampaignProgressBar&) = delete;
  CampaignProgressBar& operator=(const CampaignProgressBar&) = delete;

  void show(const evaluation::EvaluationProgress& progress);

 private:
  std::string title_;
  bool terminal_;
  int tenth_ = -1;
};

}  // namespace slalom::tools
