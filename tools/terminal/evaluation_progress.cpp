#include "tools/terminal/evaluation_progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "tools/terminal/progress_text.hpp"

namespace slalom::tools {

EvaluationProgressBar::EvaluationProgressBar(std::string title)
    : title_(std::move(title)), terminal_(isatty(STDERR_FILENO) != 0) {}

EvaluationProgressBar::~EvaluationProgressBar() {
  if (terminal_ && tenth_ >= 0) std::fputs("\n", stderr);
}

void EvaluationProgressBar::show(const evaluation::EvaluationProgress& p) {
  const int total = std::max(1, p.laps_total), tenth = p.laps_done * 10 / total;
  if (terminal_) {
    std::fprintf(stderr, "\r%s\033[K",
                 evaluation_text(title_, p, terminal_columns(stderr), has_colour(stderr)).c_str());
  } else if (tenth != tenth_) {
    constexpr int no_bar = 1000;  // lines of a log are not cut
    std::fprintf(stderr, "%s\n", evaluation_text(title_, p, no_bar, false).c_str());
  }
  tenth_ = tenth;
}

}  // namespace slalom::tools
