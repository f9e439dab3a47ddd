#include "tools/terminal/progress.hpp"
#include "tools/command_line/words.hpp"

#include <unistd.h>

namespace slalom::tools {
namespace {

std::string time_text(double seconds) {
  // An estimate below a second would be shown for longer than that.
  const long s = std::max(1L, std::lround(seconds));
  if (s >= 3600) return formatted("%ld h %02ld min", s / 3600, s / 60 % 60);
  return s >= 60 ? formatted("%ld min %02ld s", s / 60, s % 60) : formatted("%ld s", s);
}

}  // namespace

std::string evaluation_text(const evaluation::EvaluationProgress& p) {
  const std::string laps = formatted("%d of %d laps", p.laps_done, p.laps_total);
  const bool tells = p.laps_done < p.laps_total && p.laps_done > 0;
  return tells ? laps + ", " + time_text(p.seconds_left) + " left" : laps;
}

ProgressLine::ProgressLine(std::FILE* stream) : stream_(stream), terminal_(isatty(fileno(stream)) == 1) {}

ProgressLine::~ProgressLine() {
  clear();
}

bool ProgressLine::due() {
  const auto now = std::chrono::steady_clock::now();
  if (!terminal_ || now < next_) return false;
  next_ = now + std::chrono::milliseconds(50);
  return true;
}

void ProgressLine::show(int lap, int laps, const evaluation::ControlStep& tick) {
  if (!due()) return;
  std::string text =
      formatted("lap %d of %d: %.0f %%, %.1f s, %d collisions, %.1f m/s, cost %.3g", lap, laps,
                100 * tick.progress, tick.time, tick.collisions, tick.seen.speed, tick.cost.total());
  if (const SolveResult* solve = tick.output.solve) {
    text += formatted(", %.2f ms", 1e3 * solve->times.total);
    if (solve->samples)
      text += formatted(", ESS %.0f of %d", solve->effective_sample_size, solve->samples->samples());
  }
  write(text);
}

void ProgressLine::show(int race, int races, const evaluation::GridRaceStep& step) {
  if (due())
    write(formatted("race %d of %d: %.0f %%, %.1f s, %d cars, %d contacts", race, races, 100 * step.progress,
                    step.time, step.driving, step.contacts));
}

void ProgressLine::show(const evaluation::EvaluationProgress& p) {
  if (terminal_) {
    if (due()) write(evaluation_text(p));
    return;
  }
  const int tenth = p.laps_done * 10 / std::max(1, p.laps_total);
  if (tenth != tenth_) std::fprintf(stream_, "%s\n", evaluation_text(p).c_str());
  tenth_ = tenth;
}

void ProgressLine::write(const std::string& text) {
  // A line that is wider than the terminal would not be removed whole.
  std::fprintf(stream_, "\r\033[K%.*s", terminal_columns(stream_) - 1, text.c_str());
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
