#include "tools/terminal/progress_line.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace slalom::tools {
namespace {

int columns(std::FILE* stream) {
  winsize size{};
  return ioctl(fileno(stream), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string bar(double progress, int width) {
  const int full = static_cast<int>(std::lround(progress * width));
  std::string text;
  for (int i = 0; i < width; ++i) text += i < full ? '#' : '.';
  return text;
}

}  // namespace

ProgressLine::ProgressLine(std::FILE* stream) : stream_(stream), active_(isatty(fileno(stream)) == 1) {}

ProgressLine::~ProgressLine() {
  clear();
}

void ProgressLine::show(int lap, int laps, const evaluation::ControlStep& tick) {
  if (!active_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + std::chrono::milliseconds(50);
  const SolveResult* solve = tick.output.solve;
  char text[256];
  std::snprintf(text, sizeof text,
                "lap %d/%d [%s] %5.1f s  %4.1f m/s  cost %8.3g  ESS %6.0f  solve %5.2f ms  collisions %d",
                lap, laps, bar(tick.progress, 20).c_str(), tick.time, tick.seen.speed, tick.cost.total(),
                solve ? solve->effective_sample_size : 0.0, solve ? 1e3 * solve->times.total : 0.0,
                tick.collisions);
  text[std::min<std::size_t>(std::strlen(text), static_cast<std::size_t>(columns(stream_) - 1))] = '\0';
  std::fprintf(stream_, "\r\033[K%s", text);
  std::fflush(stream_);
  shown_ = true;
}

void ProgressLine::clear() {
  if (!shown_) return;
  std::fprintf(stream_, "\r\033[K");
  std::fflush(stream_);
  shown_ = false;
}

}  // namespace slalom::tools
