#include "tools/terminal/progress.hpp"
#include "tools/command_line/words.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace slalom::tools {
namespace {

constexpr int longest_bar = 30, shortest_bar = 6;  // characters
constexpr const char* green = "\033[32m";
constexpr const char* plain = "\033[0m";

std::string time_text(double seconds) {
  // An estimate below a second would be shown for longer than that.
  const long s = std::max(1L, std::lround(seconds));
  if (s >= 3600) return formatted("%ld h %02ld min", s / 3600, s / 60 % 60);
  return s >= 60 ? formatted("%ld min %02ld s", s / 60, s % 60) : formatted("%ld s", s);
}

std::string cut(const std::string& text, int columns) {
  return text.substr(0, static_cast<std::size_t>(std::max(0, columns)));
}

/// Whether colour is wanted in a terminal: NO_COLOR is not set, and TERM is not dumb.
bool wants_colour() {
  const char* term = std::getenv("TERM");
  const char* refused = std::getenv("NO_COLOR");
  return (refused == nullptr || *refused == '\0') && term != nullptr && std::strcmp(term, "dumb") != 0;
}

/// A bar of `width` characters between brackets, of which the share `progress` is full.
std::string progress_bar(double progress, int width, bool colour) {
  const auto length = static_cast<std::size_t>(std::max(0, width));
  const auto full =
      static_cast<std::size_t>(std::lround(std::clamp(progress, 0.0, 1.0) * static_cast<double>(length)));
  const std::string done(full, '#'), rest(length - full, '.');
  return "[" + (colour ? green + done + plain : done) + rest + "]";
}

}  // namespace

std::string evaluation_text(const evaluation::EvaluationProgress& p, int columns, bool colour) {
  std::string after = " " + std::to_string(p.laps_done) + " of " + std::to_string(p.laps_total) + " laps";
  if (p.laps_done < p.laps_total && p.laps_done > 0) after += ", " + time_text(p.seconds_left) + " left";
  const int room = columns - 3 - static_cast<int>(after.size());
  if (room < shortest_bar) return cut(after.substr(1), columns - 1);
  const double share = static_cast<double>(p.laps_done) / std::max(1, p.laps_total);
  return progress_bar(share, std::min(room, longest_bar), colour) + after;
}

std::string lap_text(const std::string& name, double progress, const std::vector<std::string>& parts,
                     int columns, bool colour) {
  int room = columns - 1 - static_cast<int>(name.size()) - 3 - shortest_bar;
  if (room < 0) return cut(name, columns - 1);
  std::string text;
  for (const std::string& part : parts) {
    if (static_cast<int>(part.size()) + 2 > room) break;
    text += "  " + part;
    room -= static_cast<int>(part.size()) + 2;
  }
  return name + " " + progress_bar(progress, std::min(20, shortest_bar + room), colour) + text;
}

ProgressLine::ProgressLine(std::FILE* stream) : stream_(stream), terminal_(isatty(fileno(stream)) == 1) {
  colour_ = terminal_ && wants_colour();
}

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
  std::vector<std::string> parts = {
      formatted("%.1f s", tick.time), formatted("%d collisions", tick.collisions),
      formatted("%.1f m/s", tick.seen.speed), formatted("cost %.3g", tick.cost.total())};
  if (const SolveResult* solve = tick.output.solve) {
    parts.push_back(formatted("%.2f ms", 1e3 * solve->times.total));
    if (solve->samples)
      parts.push_back(formatted("ESS %.0f of %d", solve->effective_sample_size, solve->samples->samples()));
  }
  write(lap_text(formatted("lap %d of %d", lap, laps), tick.progress, parts, terminal_columns(stream_),
                 colour_));
}

void ProgressLine::show(int race, int races, const evaluation::GridRaceStep& step) {
  if (!due()) return;
  write(lap_text(formatted("race %d of %d", race, races), step.progress,
                 {formatted("%.1f s", step.time), formatted("%d cars", step.driving),
                  formatted("%d contacts", step.contacts)},
                 terminal_columns(stream_), colour_));
}

void ProgressLine::show(const evaluation::EvaluationProgress& p) {
  if (terminal_) {
    if (due()) write(evaluation_text(p, terminal_columns(stream_), colour_));
    return;
  }
  constexpr int no_limit = 1000;  // lines of a log are not cut
  const int tenth = p.laps_done * 10 / std::max(1, p.laps_total);
  if (tenth != tenth_) std::fprintf(stream_, "%s\n", evaluation_text(p, no_limit, false).c_str());
  tenth_ = tenth;
}

void ProgressLine::write(const std::string& text) {
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
