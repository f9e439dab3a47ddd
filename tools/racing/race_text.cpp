#include "tools/racing/race_text.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::tools {
namespace {

using evaluation::RacingEnd;
using evaluation::RacingLap;
using evaluation::RacingSample;

constexpr int parts = 10;  // parts of the way in the table of a lap

std::string seconds(double time) {
  if (!std::isfinite(time)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", time);
  return text;
}

void print_group(std::FILE* out, const char* label, const RaceStatistics& group, const RacingLap& profile) {
  if (group.laps == 0) return;
  const std::string completed = std::to_string(group.completed) + " of " + std::to_string(group.laps);
  std::fprintf(out, "%-18s %9s", label, completed.c_str());
  if (group.completed > 0)
    std::fprintf(out, " %9.3f %9.3f %9s %13.3f %+11.1f %% %18.2f %9.2f %9.2f %%", group.mean, group.best,
                 ("(lap " + std::to_string(group.best_lap + 1) + ")").c_str(), group.ideal(),
                 100 * (group.best / profile.time() - 1), group.grip.p50, group.grip.p99,
                 100 * group.grip.beyond);
  std::fprintf(out, "\n");
}

}  // namespace

void print_lap_header(std::FILE* out, double grip) {
  std::fprintf(out, "%-18s %9s", "lap", "time, s");
  for (int i = 1; i <= evaluation::racing_sectors; ++i)
    std::fprintf(out, " %9s", ("sector " + std::to_string(i)).c_str());
  std::fprintf(out, " %9s %18s %9s   beyond %.2f m/s^2\n", "top, m/s", "grip p50, m/s^2", "p99", grip);
}

void print_lap(std::FILE* out, const std::string& label, const RacingLap& lap, double grip) {
  double fastest = 0;
  for (const RacingSample& sample : lap.samples) fastest = std::max(fastest, sample.speed);
  const bool completed = lap.end == RacingEnd::completed;
  std::fprintf(out, "%-18s %9s", label.c_str(), completed ? seconds(lap.time()).c_str() : "-");
  for (const double time : lap.sector) std::fprintf(out, " %9s", seconds(time).c_str());
  const auto use = evaluation::grip_use(lap.samples, grip);
  std::fprintf(out, " %9.2f %18.2f %9.2f %9.2f %%", fastest, use.p50, use.p99, 100 * use.beyond);
  if (!completed)
    std::fprintf(out, "   %s after %.1f m, %.2f s", std::string(evaluation::name(lap.end)).c_str(),
                 lap.samples.back().distance, lap.time());
  std::fprintf(out, "\n");
  std::fflush(out);
}

void print_statistics(std::FILE* out, const RaceResult& race) {
  std::fprintf(out, "\n%-18s %9s %9s %9s %9s %13s %13s %18s %9s   beyond %.2f m/s^2\n", "", "completed",
               "mean, s", "best, s", "", "best sectors", "to profile", "grip p50, m/s^2", "p99", race.grip);
  print_group(out, "flying laps", race_statistics(race, false), race.profile);
  print_group(out, "standing starts", race_statistics(race, true), race.profile_from_rest);
}

void print_along(std::FILE* out, const RaceResult& race, const RacingLap& lap, const RacingLap* other,
                 const std::string& other_name) {
  const RacingLap& profile = profile_of(race, lap);
  std::fprintf(out, "\n%s along the way\n%12s %12s %13s %18s", lap_words(race, lap).c_str(), "distance, m",
               "speed, m/s", "profile, m/s", "behind profile, s");
  if (other) std::fprintf(out, "   behind %s, s", other_name.c_str());
  std::fprintf(out, "\n");
  for (int i = 1; i <= parts; ++i) {
    const double distance = race.length * i / parts;
    const auto at = [&](const RacingLap& each) {
      return evaluation::at_distance(each.samples, distance).value_or(each.samples.back());
    };
    std::fprintf(out, "%12.1f %12.2f %13.2f %18.3f", distance, at(lap).speed, at(profile).speed,
                 evaluation::time_behind(lap.samples, profile.samples, distance));
    if (other)
      std::fprintf(out, " %+*.3f", static_cast<int>(other_name.size()) + 11,
                   evaluation::time_behind(lap.samples, other->samples, distance));
    std::fprintf(out, "\n");
  }
}

std::string lap_words(const RaceResult& race, const RacingLap& lap) {
  char text[80];
  std::snprintf(text, sizeof text, "lap %d (%s) %.3f s", static_cast<int>(&lap - race.laps.data()) + 1,
                lap.standing ? "standing start" : "flying", lap.time());
  return text;
}

}  // namespace slalom::tools
