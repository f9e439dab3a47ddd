#include "tools/terminal/evaluation_progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace slalom::tools {
namespace {

std::string time_text(double seconds) {
  char text[32];
  const long s = std::lround(seconds);
  if (s >= 3600) {
    std::snprintf(text, sizeof text, "%ld h %02ld min", s / 3600, s / 60 % 60);
  } else if (s >= 60) {
    std::snprintf(text, sizeof text, "%ld min %02ld s", s / 60, s % 60);
  } else {
    std::snprintf(text, sizeof text, "%ld s", s);
  }
  return text;
}

}  // namespace

EvaluationProgressBar::EvaluationProgressBar(std::string title)
    : title_(title.empty() ? "" : title + ": "), terminal_(isatty(STDERR_FILENO) != 0) {}

EvaluationProgressBar::~EvaluationProgressBar() {
  if (terminal_ && tenth_ >= 0) std::fputs("\n", stderr);
}

void EvaluationProgressBar::show(const evaluation::EvaluationProgress& p) {
  const int total = std::max(1, p.laps_total), tenth = p.laps_done * 10 / total;
  if (terminal_) {
    std::string bar(30, '.');
    std::fill_n(bar.begin(), p.laps_done * 30 / total, '#');
    std::fprintf(stderr, "\r%s[%s] %d of %d laps, %s left \033[K", title_.c_str(), bar.c_str(), p.laps_done,
                 p.laps_total, time_text(p.seconds_left).c_str());
  } else if (tenth != tenth_) {
    std::fprintf(stderr, "%s%d of %d laps, %s left\n", title_.c_str(), p.laps_done, p.laps_total,
                 time_text(p.seconds_left).c_str());
  }
  tenth_ = tenth;
}

}  // namespace slalom::tools
