#include "tools/commands/navigate_report.hpp"

#include "json/json.hpp"
#include "slalom/evaluation/statistics.hpp"
#include "tools/command_line/words.hpp"
#include "tools/drawing/map_picture.hpp"

namespace slalom::tools {
namespace {

using evaluation::Interval;
using evaluation::RoomDrive;
using evaluation::RoomOutcome;
using evaluation::RoomScenario;
using Drives = std::vector<const RoomDrive*>;

Drives drives_of(const RoomSeries& series) {
  Drives drives;
  for (const RoomDrive& drive : series.drives) drives.push_back(&drive);
  return drives;
}

/// A figure of a drive, with its heading in tables, its key in JSON, and the decimals of a difference.
struct Figure {
  const char *heading, *key;
  int digits;
  double (*value)(const RoomDrive&);
};

constexpr Figure figures[] = {
    {"time, s", "time_s", 1, [](const RoomDrive& d) { return d.time; }},
    {"length, m", "length_m", 1, [](const RoomDrive& d) { return d.length; }},
    {"changes of side", "side_changes", 2, [](const RoomDrive& d) { return double(d.side_changes); }},
    {"reversals", "reversals", 2, [](const RoomDrive& d) { return double(d.reversals); }},
    {"change of the yaw rate, rad/s", "command_change_rad_s", 4,
     [](const RoomDrive& d) { return d.command_change; }},
    {"turns to the other side", "turn_changes", 1, [](const RoomDrive& d) { return double(d.turn_changes); }},
    {"aside, m", "aside_m", 3, [](const RoomDrive& d) { return d.aside; }},
    {"from the goal, m", "goal_distance_m", 3, [](const RoomDrive& d) { return d.goal_distance; }},
    {"from its heading, rad", "goal_angle_rad", 3, [](const RoomDrive& d) { return d.goal_angle; }},
    {"BARN's metric", "barn_metric", 4, [](const RoomDrive& d) { return d.metric; }}};

/// The figures of a table: BARN's metric only if the scenarios have one.
std::span<const Figure> figures_of(const std::vector<RoomSeries>& all) {
  const std::span<const Figure> every = figures;
  return all.front().scenario->optimal_time > 0 ? every : every.first(every.size() - 1);
}

double success_of(const RoomDrive& drive) {
  return drive.success;
}
double collision_of(const RoomDrive& drive) {
  return collided(drive);
}

std::vector<double> values_of(const Drives& drives, double (*value)(const RoomDrive&)) {
  std::vector<double> values;
  for (const RoomDrive* drive : drives) values.push_back(value(*drive));
  return values;
}

int count_of(const Drives& drives, double (*value)(const RoomDrive&)) {
  return static_cast<int>(
      std::count_if(drives.begin(), drives.end(), [&](const RoomDrive* each) { return value(*each) > 0; }));
}

std::string text_of(double value, int digits) {
  // Without the sign of a zero.
  return formatted("%.*f", digits, std::abs(value) < 0.5 * std::pow(10, -digits) ? 0 : value);
}

/// "mean [low, high]", with the 95 % bootstrap interval; one value has none.
std::string mean_text(const std::vector<double>& values, int digits = 1) {
  if (values.size() == 1) return text_of(values[0], digits);
  const Interval interval = evaluation::bootstrap_mean(values);
  return text_of(evaluation::mean(values), digits) + " [" + text_of(interval.low, digits) + ", " +
         text_of(interval.high, digits) + "]";
}

/// A row of a table: scenario, driver, "n of m (low to high %)" with the 95 % Wilson interval, collisions,
/// and the means of the figures.
std::string markdown_row(const std::string& scenario, const std::string& driver, const Drives& drives,
                         std::span<const Figure> shown) {
  const int successes = count_of(drives, success_of);
  const Interval rate = evaluation::wilson_interval(successes, static_cast<std::int64_t>(drives.size()));
  std::string row = "| " + scenario + " | " + driver + " | " + std::to_string(successes) + " of " +
                    std::to_string(drives.size()) + " (" + text_of(100 * rate.low, 0) + " to " +
                    text_of(100 * rate.high, 0) + " %) | " + std::to_string(count_of(drives, collision_of));
  for (const Figure& figure : shown)
    row += " | " + mean_text(values_of(drives, figure.value), std::max(figure.digits - 1, 1));
  return row + " |\n";
}

/// The means of the first driver minus those of another, drive by drive.
std::string difference_row(const std::string& driver, const Drives& first, const Drives& other,
                           std::span<const Figure> shown) {
  const auto difference = [&](double (*value)(const RoomDrive&), int digits) {
    std::vector<double> values;
    for (std::size_t i = 0; i < std::min(first.size(), other.size()); ++i)
      values.push_back(value(*first[i]) - value(*other[i]));
    return " | " + mean_text(values, digits);
  };
  std::string row = "| all | " + driver + difference(success_of, 3) + difference(collision_of, 3);
  for (const Figure& figure : shown) row += difference(figure.value, figure.digits);
  return row + " |\n";
}

constexpr int moment_interval = 3;  // s
constexpr Colour person_fill = {0.93, 0.75, 0.25, 0.55}, person_rim = {0.55, 0.40, 0.05, 1};

std::vector<maps::Point> outline(const maps::Pose& pose, const RoomScenario& scenario) {
  const auto corners = sim::corners({pose, scenario.robot_length, scenario.robot_width});
  return {corners.begin(), corners.end()};
}

std::vector<maps::Point> circle(const maps::Point& middle, double radius) {
  std::vector<maps::Point> points;
  constexpr int corners = 24;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    points.push_back({middle.x + radius * std::cos(angle), middle.y + radius * std::sin(angle)});
  }
  return points;
}

/// Draws robot and people of a drive, every moment_interval.
void draw_moments(MapPicture& picture, const RoomDrive& drive, const RoomScenario& scenario,
                  const Colour& colour) {
  const auto periods = static_cast<std::size_t>(std::lround(moment_interval / evaluation::room_period));
  for (std::size_t k = 0; k < drive.people.size(); ++k)
    picture.line(drive.people[k], person_rim, 2, false, true);
  if (drive.people.empty()) return;
  for (std::size_t i = 0; i < drive.trace.size(); i += periods) {
    picture.line(outline(drive.trace[i], scenario), colour, 1.5, true);
    for (std::size_t k = 0; k < drive.people.size(); ++k)
      picture.polygon(circle(drive.people[k][i], scenario.walkers[k].radius), person_fill, person_rim);
  }
}

}  // namespace

bool collided(const RoomDrive& drive) {
  return drive.outcome == RoomOutcome::collision || drive.outcome == RoomOutcome::struck;
}

Json summary_of(const RoomSeries& series) {
  double slowest = 0;
  Json by_seed = Json::array();
  for (const RoomDrive& d : series.drives) {
    slowest = std::max(slowest, d.update_max);
    Json row{{"outcome", evaluation::name(d.outcome)}, {"success", d.success}};
    for (const Figure& figure : figures) row[figure.key] = figure.value(d);
    row.update({{"answer_time_s", d.answer_time},
                {"update_p50_ms", 1e3 * d.update_p50},
                {"update_max_ms", 1e3 * d.update_max}});
    by_seed.push_back(std::move(row));
  }
  const Drives drives = drives_of(series);
  const int successes = count_of(drives, success_of);
  const auto count = static_cast<std::int64_t>(drives.size());
  const Interval rate = evaluation::wilson_interval(successes, count);
  Json summary{{"scenario", series.scenario->name},
               {"driver", series.driver},
               {"drives", count},
               {"successes", successes},
               {"success_rate", {{"low", rate.low}, {"high", rate.high}}},
               {"collisions", count_of(drives, collision_of)}};
  for (const Figure& figure : figures) {
    const std::vector<double> values = values_of(drives, figure.value);
    const Interval interval = evaluation::bootstrap_mean(values);
    summary[figure.key] = {
        {"mean", evaluation::mean(values)}, {"low", interval.low}, {"high", interval.high}};
  }
  summary["update_max_ms"] = 1e3 * slowest;
  summary["by_seed"] = by_seed;
  return summary;
}

std::string markdown_table(const std::vector<RoomSeries>& all) {
  const std::span<const Figure> shown = figures_of(all);
  std::string text = "| scenario | driver | success | collisions";
  for (const Figure& figure : shown) text += std::string(" | ") + figure.heading;
  text += " |\n|---|---|---|---";
  for (std::size_t i = 0; i < shown.size(); ++i) text += "|---";
  text += "|\n";
  std::vector<std::pair<std::string, Drives>> drivers;
  for (const RoomSeries& series : all) {
    const Drives drives = drives_of(series);
    if (series.scenario->optimal_time == 0)  // the 300 worlds of BARN have one row together
      text += markdown_row("`" + series.scenario->name + "`", "`" + series.driver + "`", drives, shown);
    auto found = std::find_if(drivers.begin(), drivers.end(),
                              [&](const auto& each) { return each.first == series.driver; });
    if (found == drivers.end()) found = drivers.insert(drivers.end(), {series.driver, {}});
    found->second.insert(found->second.end(), drives.begin(), drives.end());
  }
  for (const auto& [name, drives] : drivers) text += markdown_row("all", "`" + name + "`", drives, shown);
  for (std::size_t i = 1; i < drivers.size(); ++i)
    text += difference_row("`" + drivers[0].first + "` minus `" + drivers[i].first + "`", drivers[0].second,
                           drivers[i].second, shown);
  return text;
}

void draw(const std::vector<RoomSeries>& all, const RoomScenario& scenario, const std::string& folder) {
  MapPicture picture(sim::map_of(scenario.room, 0.05));
  for (const sim::Box& box : scenario.room.obstacles) {
    const auto corners = sim::corners(box);
    picture.polygon({corners.begin(), corners.end()}, {0.55, 0.58, 0.63, 1}, {0.3, 0.33, 0.38, 1});
  }
  for (const sim::Disc& post : scenario.room.posts)
    picture.polygon(circle(post.middle, post.radius), {0.55, 0.58, 0.63, 1}, {0.3, 0.33, 0.38, 1});
  std::vector<std::pair<std::string, Colour>> key;
  std::size_t index = 0;
  for (const RoomSeries& series : all) {
    if (series.scenario != &scenario) continue;
    Colour colour = method_colour(series.driver);
    colour.opacity = 0.75;
    ++index;
    key.emplace_back(series.driver, colour);
    for (const RoomDrive& drive : series.drives) {
      if (index == 1 && &drive == &series.drives.front()) draw_moments(picture, drive, scenario, colour);
      std::vector<maps::Point> points;
      for (const maps::Pose& pose : drive.trace) points.push_back({pose.x, pose.y});
      picture.line(points, colour, 3, false);
      picture.line(outline(drive.trace.back(), scenario), colour, 2, true);
      if (index == 1) picture.arrow(drive.goal, 20, {0.13, 0.16, 0.22, 1});
    }
  }
  if (!scenario.walkers.empty())
    key.emplace_back("people, every " + std::to_string(moment_interval) + " s", person_rim);
  picture.arrow(scenario.start, 20, {0.13, 0.16, 0.22, 1});
  picture.key(scenario.name, scenario.summary, key);
  picture.save(std::filesystem::path(folder) / (scenario.name + ".png"));
}

}  // namespace slalom::tools
