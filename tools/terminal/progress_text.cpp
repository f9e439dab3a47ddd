#include "tools/terminal/progress_text.hpp"

#include <sys/ioctl.h>
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
  char text[32];
  // An estimate below a second would be shown for longer than that.
  const long s = std::max(1L, std::lround(seconds));
  if (s >= 3600)
    std::snprintf(text, sizeof text, "%ld h %02ld min", s / 3600, s / 60 % 60);
  else if (s >= 60)
    std::snprintf(text, sizeof text, "%ld min %02ld s", s / 60, s % 60);
  else
    std::snprintf(text, sizeof text, "%ld s", s);
  return text;
}

std::string cut(std::string text, int columns) {
  const auto most = static_cast<std::size_t>(std::max(0, columns));
  if (text.size() > most) text.resize(most);
  return text;
}

}  // namespace

int terminal_columns(std::FILE* stream) {
  winsize size{};
  return ioctl(fileno(stream), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

bool has_colour(std::FILE* stream) {
  const char* term = std::getenv("TERM");
  const char* refused = std::getenv("NO_COLOR");
  return isatty(fileno(stream)) == 1 && (refused == nullptr || *refused == '\0') && term != nullptr &&
         std::strcmp(term, "dumb") != 0;
}

std::string progress_bar(double progress, int width, bool colour) {
  const auto length = static_cast<std::size_t>(std::max(0, width));
  const auto full =
      static_cast<std::size_t>(std::lround(std::clamp(progress, 0.0, 1.0) * static_cast<double>(length)));
  const std::string done(full, '#'), rest(length - full, '.');
  return "[" + (colour ? green + done + plain : done) + rest + "]";
}

std::string evaluation_text(const std::string& title, const evaluation::EvaluationProgress& p, int columns,
                            bool colour) {
  const int total = std::max(1, p.laps_total), room = columns - 1;
  std::string after = " " + std::to_string(p.laps_done) + " of " + std::to_string(p.laps_total) + " laps";
  if (p.laps_done < p.laps_total && p.laps_done > 0) after += ", " + time_text(p.seconds_left) + " left";
  const std::string before = title.empty() ? "" : title + ": ";
  const int rest = room - 2 - static_cast<int>(before.size() + after.size());
  if (rest < shortest_bar) return cut(before + after.substr(1), room);
  return before +
         progress_bar(static_cast<double>(p.laps_done) / total, std::min(rest, longest_bar), colour) + after;
}

std::string lap_text(const std::string& lap, double progress, const std::vector<std::string>& parts,
                     int columns, bool colour) {
  int room = columns - 1 - static_cast<int>(lap.size()) - 3 - shortest_bar;
  if (room < 0) return cut(lap, columns - 1);
  std::string text;
  for (const std::string& part : parts) {
    if (static_cast<int>(part.size()) + 2 > room) break;
    text += "  " + part;
    room -= static_cast<int>(part.size()) + 2;
  }
  return lap + " " + progress_bar(progress, std::min(20, shortest_bar + room), colour) + text;
}

}  // namespace slalom::tools
