#include "tools/racing/race_result.hpp"

#include <numeric>

#include "json/json.hpp"
#include "tools/command_line/words.hpp"
#include "tools/terminal/text_table.hpp"

namespace slalom::tools {
namespace {

using evaluation::RacingEnd;
using evaluation::RacingLap;
using evaluation::RacingSample;

/// A number of a sample, as it is named and rounded in results.
struct SampleColumn {
  const char* key;
  double RacingSample::*value;
  double resolution;
};
constexpr SampleColumn sample_columns[] = {{"distance_m", &RacingSample::distance, 1e-5},
                                           {"time_s", &RacingSample::time, 1e-6},
                                           {"speed_mps", &RacingSample::speed, 1e-5},
                                           {"longitudinal_mps2", &RacingSample::longitudinal, 1e-4},
                                           {"lateral_mps2", &RacingSample::lateral, 1e-4}};

/// The largest speed of a lap, m/s.
double top_speed(const RacingLap& lap) {
  double fastest = 0;
  for (const RacingSample& sample : lap.samples) fastest = std::max(fastest, sample.speed);
  return fastest;
}

Json samples_json(const std::vector<RacingSample>& samples) {
  Json json = Json::object();
  for (const SampleColumn& column : sample_columns) {
    std::vector<double> values;
    for (const RacingSample& sample : samples)
      values.push_back(std::round(sample.*column.value / column.resolution) * column.resolution);
    json[column.key] = values;
  }
  return json;
}

/// The figures of a lap.
template <class Visit>
void visit_lap(const RacingLap& lap, double grip, Visit&& visit) {
  using evaluation::Figure;
  visit(lap.end == RacingEnd::completed ? lap.time() : RaceStatistics::none,
        Figure{"time", "s", "of a completed lap"});
  visit(lap.sector, Figure{"sectors", "s", "times of the sectors"});
  visit(top_speed(lap), Figure{"top_speed", "m/s", "largest speed"});
  evaluation::visit_figures(evaluation::grip_use(lap.samples, grip), visit);
}

Json timed_json(const RacingLap& lap, double grip) {
  Json json = Json::object();
  visit_lap(lap, grip,
            [&](const auto& value, const evaluation::Figure& figure) { json[figure.name] = value; });
  return json;
}

constexpr int parts = 10;  // parts of the way in the table of a lap

}  // namespace

double RaceStatistics::ideal() const noexcept {
  return std::accumulate(best_sector.begin(), best_sector.end(), 0.0);
}

RaceStatistics race_statistics(const RaceResult& race, bool standing) {
  RaceStatistics statistics;
  std::vector<RacingSample> samples;
  for (std::size_t i = 0; i < race.laps.size(); ++i) {
    const RacingLap& lap = race.laps[i];
    if (lap.standing != standing) continue;
    ++statistics.laps;
    if (lap.end != RacingEnd::completed) continue;
    const bool first = statistics.completed++ == 0;
    statistics.mean = (first ? 0 : statistics.mean) + lap.time();
    for (std::size_t k = 0; k < lap.sector.size(); ++k)
      statistics.best_sector[k] = first ? lap.sector[k] : std::min(statistics.best_sector[k], lap.sector[k]);
    samples.insert(samples.end(), lap.samples.begin(), lap.samples.end());
    if (!first && lap.time() >= statistics.best) continue;
    statistics.best = lap.time();
    statistics.best_lap = static_cast<int>(i);
  }
  if (statistics.completed > 0) statistics.mean /= statistics.completed;
  statistics.grip = evaluation::grip_use(samples, race.grip);
  return statistics;
}

const RacingLap& profile_of(const RaceResult& race, const RacingLap& lap) {
  return lap.standing ? race.profile_from_rest : race.profile;
}

const RacingLap* best_lap(const RaceResult& race) {
  for (const bool standing : {false, true})
    if (const int best = race_statistics(race, standing).best_lap; best >= 0)
      return &race.laps[static_cast<std::size_t>(best)];
  return nullptr;
}

Json race_json(const RaceResult& race) {
  Json json{{"length_m", race.length},
            {"friction_circle_mps2", race.grip},
            {"profile", timed_json(race.profile, race.grip)},
            {"profile_from_rest", timed_json(race.profile_from_rest, race.grip)},
            {"flying", figures_json(race_statistics(race, false))},
            {"standing", figures_json(race_statistics(race, true))},
            {"laps", Json::array()}};
  for (std::size_t i = 0; i < race.laps.size(); ++i) {
    const RacingLap& lap = race.laps[i];
    Json row{{"lap", static_cast<int>(i) + 1},
             {"start", lap.standing ? "standing" : "flying"},
             {"seed", lap.seed},
             {"end", std::string(evaluation::name(lap.end))},
             {"distance", lap.samples.back().distance}};
    row.update(timed_json(lap, race.grip));
    row["samples"] = samples_json(lap.samples);
    json["laps"].push_back(row);
  }
  return json;
}

void print_lap_header(std::FILE* out, double grip) {
  std::fprintf(out, "%-18s %9s", "lap", "time, s");
  for (int i = 1; i <= evaluation::racing_sectors; ++i)
    std::fprintf(out, " %9s", ("sector " + std::to_string(i)).c_str());
  std::fprintf(out, " %9s %18s %9s   beyond %.2f m/s^2\n", "top, m/s", "grip p50, m/s^2", "p99", grip);
}

void print_lap(std::FILE* out, const std::string& label, const RacingLap& lap, double grip) {
  const bool completed = lap.end == RacingEnd::completed;
  std::fprintf(out, "%-18s %9s", label.c_str(), completed ? number_cell(lap.time()).c_str() : "-");
  for (const double time : lap.sector) std::fprintf(out, " %9s", number_cell(time).c_str());
  const auto use = evaluation::grip_use(lap.samples, grip);
  std::fprintf(out, " %9.2f %18.2f %9.2f %9.2f %%", top_speed(lap), use.p50, use.p99, 100 * use.beyond);
  if (!completed)
    std::fprintf(out, "   %s after %.1f m, %.2f s", std::string(evaluation::name(lap.end)).c_str(),
                 lap.samples.back().distance, lap.time());
  std::fprintf(out, "\n");
  std::fflush(out);
}

void print_statistics(std::FILE* out, const RaceResult& race) {
  std::fprintf(out, "\n");
  std::vector<std::string> heads = figure_heads({"<"}, RaceStatistics{});
  heads.emplace_back("to profile, %");
  TextTable table(std::move(heads));
  for (const bool standing : {false, true}) {
    const RaceStatistics group = race_statistics(race, standing);
    if (group.laps == 0) continue;
    const double profile = (standing ? race.profile_from_rest : race.profile).time();
    std::vector<std::string> row = figure_cells({standing ? "standing starts" : "flying laps"}, group);
    row.push_back(number_cell(100 * (group.best / profile - 1), 1));
    table.add(std::move(row));
  }
  table.print(out);
}

void print_along(std::FILE* out, const RaceResult& race, const RacingLap& lap) {
  const RacingLap& profile = profile_of(race, lap);
  std::fprintf(out, "\n%s along the way\n%12s %12s %13s %18s\n", lap_words(race, lap).c_str(), "distance, m",
               "speed, m/s", "profile, m/s", "behind profile, s");
  for (int i = 1; i <= parts; ++i) {
    const double distance = race.length * i / parts;
    const auto at = [&](const RacingLap& each) {
      return evaluation::at_distance(each.samples, distance).value_or(each.samples.back());
    };
    std::fprintf(out, "%12.1f %12.2f %13.2f %18.3f\n", distance, at(lap).speed, at(profile).speed,
                 evaluation::time_behind(lap.samples, profile.samples, distance));
  }
}

std::string lap_words(const RaceResult& race, const RacingLap& lap) {
  return formatted("lap %d (%s) %.3f s", static_cast<int>(&lap - race.laps.data()) + 1,
                   lap.standing ? "standing start" : "flying", lap.time());
}

}  // namespace slalom::tools
