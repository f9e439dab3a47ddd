#include "tools/racing/race_result.hpp"

#include <numeric>

#include "json/json.hpp"
#include "tools/command_line/words.hpp"
#include "tools/drawing/drawing.hpp"
#include "tools/drawing/row_chart.hpp"
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

using evaluation::RacingLap;
using evaluation::RacingSample;

constexpr Colour lap_colour{0.12, 0.42, 0.78, 1}, profile_colour{0.45, 0.48, 0.55, 1},
    beyond_colour{0.80, 0.13, 0.23, 1};
constexpr double width = 1240, height = 720, left = 64, right = 800, speed_top = 112, speed_bottom = 400,
                 delta_top = 456, delta_bottom = 660, circle_left = 876, circle_right = 1212,
                 circle_top = 112, circle_bottom = circle_top + circle_right - circle_left;
constexpr int delta_steps = 400;

void draw_frame(Pen& pen, const Axis& x, const Axis& y, const std::string& title, const std::string& below) {
  pen.text(x.from, y.to - 12, 14, title, ink, 0, true);
  for (const double tick : x.ticks) {
    pen.line(x(tick), y.from, x(tick), y.to, rule, 1);
    pen.text(x(tick), y.from + 17, 12, short_number(tick), faint_ink, 0.5);
  }
  for (const double tick : y.ticks) {
    pen.line(x.from, y(tick), x.to, y(tick), tick == 0 ? faint_ink : rule, 1);
    pen.text(x.from - 8, y(tick) + 4, 12, short_number(tick), faint_ink, 1);
  }
  pen.text(0.5 * (x.from + x.to), y.from + 36, 12.5, below, faint_ink, 0.5);
}

void draw_sectors(Pen& pen, const Axis& x, const Axis& y, double length) {
  for (int i = 1; i < evaluation::racing_sectors; ++i) {
    const double at = x(length * i / evaluation::racing_sectors);
    pen.line(at, y.from, at, y.to, faint_ink, 1, true);
  }
}

Pen::Points speeds(const RacingLap& lap, const Axis& x, const Axis& y) {
  Pen::Points points;
  for (const RacingSample& sample : lap.samples) points.emplace_back(x(sample.distance), y(sample.speed));
  return points;
}

void draw_speeds(Pen& pen, const RacePicture& picture, const Axis& x) {
  double fastest = 1;
  for (const RacingLap* lap : {&picture.lap.lap, &picture.profile.lap})
    for (const RacingSample& sample : lap->samples) fastest = std::max(fastest, sample.speed);
  const Axis y = linear_axis(0, fastest, speed_bottom, speed_top, 5);
  draw_frame(pen, x, y, "speed, m/s", "");
  draw_sectors(pen, x, y, picture.length);
  pen.stroke(speeds(picture.profile.lap, x, y), {profile_colour, 1.6, 5});
  pen.stroke(speeds(picture.lap.lap, x, y), {lap_colour, 2});
}

void draw_deltas(Pen& pen, const RacePicture& picture, const Axis& x) {
  std::vector<double> behind;
  double low = -0.01, high = 0.01;
  for (int i = 0; i <= delta_steps; ++i) {
    behind.push_back(evaluation::time_behind(picture.lap.lap.samples, picture.profile.lap.samples,
                                             picture.length * i / delta_steps));
    low = std::min(low, behind.back());
    high = std::max(high, behind.back());
  }
  const Axis y = linear_axis(low, high, delta_bottom, delta_top, 4);
  draw_frame(pen, x, y, "time of the lap minus time of the profile, s", "distance along the course, m");
  draw_sectors(pen, x, y, picture.length);
  Pen::Points points;
  for (int i = 0; i <= delta_steps; ++i)
    points.emplace_back(x(picture.length * i / delta_steps), y(behind[static_cast<std::size_t>(i)]));
  pen.stroke(points, {profile_colour, 1.6, 5});
}

void draw_circle(Pen& pen, const RacePicture& picture) {
  double most = picture.grip;
  for (const RacingSample& s : picture.lap.lap.samples)
    most = std::max({most, std::abs(s.lateral), std::abs(s.longitudinal)});
  most *= 1.05;
  // Lateral accelerations are positive to the left, and so they are drawn.
  Axis x = linear_axis(-most, most, circle_left, circle_right, 6, true);
  std::swap(x.low, x.high);
  const Axis y = linear_axis(-most, most, circle_bottom, circle_top, 6, true);
  draw_frame(pen, x, y, "acceleration, m/s\xC2\xB2", "to the left, m/s\xC2\xB2");
  Pen::Points circle;
  constexpr int corners = 180;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * 3.14159265358979323846 * i / corners;
    circle.emplace_back(x(picture.grip * std::cos(angle)), y(picture.grip * std::sin(angle)));
  }
  pen.stroke(circle, {faint_ink, 1.6}, true);
  for (std::size_t i = 1; i < picture.lap.lap.samples.size(); ++i) {
    const RacingSample& s = picture.lap.lap.samples[i];
    const bool beyond = std::hypot(s.longitudinal, s.lateral) > picture.grip;
    Colour colour = beyond ? beyond_colour : lap_colour;
    colour.opacity = 0.6;
    pen.disc(x(s.lateral), y(s.longitudinal), 2.4, colour);
  }
  const auto use = evaluation::grip_use(picture.lap.lap.samples, picture.grip);
  const std::string words = formatted("circle: %.2f m/s\xC2\xB2; %.1f %% of the time beyond it (red)",
                                      picture.grip, 100 * use.beyond);
  pen.text(circle_left, circle_bottom + 62, 12.5, words, faint_ink);
}

void draw_key(Pen& pen, const RacePicture& picture) {
  double x = left;
  const auto entry = [&](const std::string& name, const Stroke& stroke) {
    pen.stroke({{x, 71}, {x + 26, 71}}, stroke);
    pen.text(x + 33, 75, 13, name, ink);
    x += 33 + pen.text_width(name, 13) + 26;
  };
  entry(picture.lap.name, {lap_colour, 2});
  entry(picture.profile.name, {profile_colour, 1.6, 5});
}

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

void draw_race(const RacePicture& picture, const std::filesystem::path& file) {
  const auto draw = [&](Pen& pen) {
    pen.text(left, 28, 18, picture.title, ink, 0, true);
    pen.text(left, 50, 13, picture.facts, faint_ink);
    draw_key(pen, picture);
    const Axis x = linear_axis(0, picture.length, left, right, 8, true);
    draw_speeds(pen, picture, x);
    draw_deltas(pen, picture, x);
    draw_circle(pen, picture);
  };
  save({width, height, draw}, file);
}

}  // namespace slalom::tools
