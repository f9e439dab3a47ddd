#include "tools/terminal/progress_line.hpp"

#include <unistd.h>

#include "tools/terminal/progress_text.hpp"

namespace slalom::tools {
namespace {

template <class... Values>
std::string formatted(const char* format, Values... values) {
  char text[64];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

}  // namespace

ProgressLine::ProgressLine(std::FILE* stream) : stream_(stream), active_(isatty(fileno(stream)) == 1) {}

ProgressLine::~ProgressLine() {
  clear();
}

bool ProgressLine::due() {
  const auto now = std::chrono::steady_clock::now();
  if (!active_ || now < next_) return false;
  next_ = now + std::chrono::milliseconds(50);
  return true;
}

void ProgressLine::show(int lap, int laps, const evaluation::ControlStep& tick) {
  if (!due()) return;
  const SolveResult* solve = tick.output.solve;
  std::vector<std::string> parts = {
      formatted("%.1f s", tick.time), formatted("%d collisions", tick.collisions),
      formatted("%.1f m/s", tick.seen.speed), formatted("cost %.3g", tick.cost.total())};
  if (solve) {
    parts.push_back(formatted("%.2f ms", 1e3 * solve->times.total));
    if (solve->samples)
      parts.push_back(formatted("ESS %.0f of %d", solve->effective_sample_size, solve->samples->samples()));
  }
  write(formatted("lap %d of %d", lap, laps), tick.progress, parts);
}

void ProgressLine::show(int race, int races, const evaluation::GridRaceStep& step) {
  if (!due()) return;
  write(formatted("race %d of %d", race, races), step.progress,
        {formatted("%.1f s", step.time), formatted("%d cars", step.driving),
         formatted("%d contacts", step.contacts)});
}

void ProgressLine::write(const std::string& title, double progress, const std::vector<std::string>& parts) {
  const std::string text = lap_text(title, progress, parts, terminal_columns(stream_), has_colour(stream_));
  std::fprintf(stream_, "\r\033[K%s", text.c_str());
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
