#include "tools/commands/navigate_report.hpp"

#include "json/json.hpp"
#include "slalom/evaluation/statistics.hpp"
#include "tools/command_line/words.hpp"
#include "tools/drawing/map_picture.hpp"
#include "tools/terminal/text_table.hpp"

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

using Cells = std::vector<std::string>;

/// "n of m (low to high %)" with the 95 % Wilson interval, collisions, and the means of the figures.
Cells cells_of(const Drives& drives, std::span<const Figure> shown) {
  const int successes = count_of(drives, success_of);
  const Interval rate = evaluation::wilson_interval(successes, static_cast<std::int64_t>(drives.size()));
  Cells cells{std::to_string(successes) + " of " + std::to_string(drives.size()) + " (" +
                  text_of(100 * rate.low, 0) + " to " + text_of(100 * rate.high, 0) + " %)",
              std::to_string(count_of(drives, collision_of))};
  for (const Figure& figure : shown)
    cells.push_back(mean_text(values_of(drives, figure.value), std::max(figure.digits - 1, 1)));
  return cells;
}

/// The means of the first driver minus those of another, drive by drive.
Cells differences(const Drives& first, const Drives& other, std::span<const Figure> shown) {
  const auto difference = [&](double (*value)(const RoomDrive&), int digits) {
    std::vector<double> values;
    for (std::size_t i = 0; i < std::min(first.size(), other.size()); ++i)
      values.push_back(value(*first[i]) - value(*other[i]));
    return mean_text(values, digits);
  };
  Cells cells{difference(success_of, 3), difference(collision_of, 3)};
  for (const Figure& figure : shown) cells.push_back(difference(figure.value, figure.digits));
  return cells;
}

/// The drives of each driver in all scenarios, in the order of the drivers.
std::vector<std::pair<std::string, Drives>> by_driver(const std::vector<RoomSeries>& all) {
  std::vector<std::pair<std::string, Drives>> drivers;
  for (const RoomSeries& series : all) {
    auto found = std::find_if(drivers.begin(), drivers.end(),
                              [&](const auto& each) { return each.first == series.driver; });
    if (found == drivers.end()) found = drivers.insert(drivers.end(), {series.driver, {}});
    for (const RoomDrive* drive : drives_of(series)) found->second.push_back(drive);
  }
  return drivers;
}

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

/// Draws the ways of the people of a drive, and robot and people at one moment: with somebody nearest to it.
void draw_people(MapPicture& picture, const RoomDrive& drive, const RoomScenario& scenario,
                 const Colour& colour) {
  std::size_t moment = 0;
  double nearest = INFINITY;
  for (const std::vector<maps::Point>& way : drive.people) {
    picture.line(way, person_rim, 2, false, true);
    for (std::size_t i = 0; i < std::min(way.size(), drive.trace.size()); ++i) {
      const double distance = std::hypot(way[i].x - drive.trace[i].x, way[i].y - drive.trace[i].y);
      if (distance < nearest) nearest = distance, moment = i;
    }
  }
  if (drive.people.empty()) return;
  picture.polygon(outline(drive.trace[moment], scenario), colour, white);
  for (std::size_t k = 0; k < drive.people.size(); ++k)
    picture.polygon(circle(drive.people[k][moment], scenario.walkers[k].radius), person_fill, person_rim);
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

void print(const std::vector<RoomSeries>& all, std::FILE* out) {
  const std::span<const Figure> shown = figures_of(all);
  const auto drivers = by_driver(all);
  std::vector<std::pair<std::string, Cells>> columns;
  std::string sentence;
  for (const auto& [name, drives] : drivers) {
    columns.emplace_back(name, cells_of(drives, shown));
    const Cells& cells = columns.back().second;
    const std::string rate = cells[0].substr(0, cells[0].find(" ("));
    sentence += sentence.empty() ? name + " succeeds in " + rate + " drives (" + cells[1] + " collisions)"
                                 : ",\n" + name + " in " + rate + " (" + cells[1] + ")";
  }
  std::fprintf(out, "%s\n", sentence.c_str());
  for (std::size_t i = 1; i < drivers.size(); ++i)
    columns.emplace_back(drivers[0].first + " - " + drivers[i].first,
                         differences(drivers[0].second, drivers[i].second, shown));
  TextTable scenarios({"<scenario", "<driver", "<success", "collisions", "time, s"});
  for (const RoomSeries& series : all)
    if (series.scenario->optimal_time == 0 && all.size() > drivers.size()) {
      const Cells cells = cells_of(drives_of(series), shown.first(1));
      scenarios.add({series.scenario->name, series.driver, cells[0], cells[1], cells[2]});
    }
  if (!scenarios.empty()) std::fprintf(out, "\n"), scenarios.print(out);
  // As many drivers beside one another as there is room for.
  const auto room =
      static_cast<std::size_t>(std::clamp((std::min(terminal_columns(out), 100) - 30) / 25, 1, 2));
  for (std::size_t from = 0; from < columns.size(); from += room) {
    const std::size_t to = std::min(from + room, columns.size());
    std::vector<std::string> heads{"<"};
    for (std::size_t k = from; k < to; ++k) heads.push_back(columns[k].first);
    TextTable table(heads);
    for (std::size_t row = 0; row < shown.size() + 2; ++row) {
      std::vector<std::string> cells{row == 0 ? "success" : row == 1 ? "collisions" : shown[row - 2].heading};
      for (std::size_t k = from; k < to; ++k) cells.push_back(columns[k].second[row]);
      table.add(cells);
    }
    std::fprintf(out, "\n");
    table.print(out);
  }
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
      if (index == 1 && &drive == &series.drives.front()) draw_people(picture, drive, scenario, colour);
      std::vector<maps::Point> points;
      for (const maps::Pose& pose : drive.trace) points.push_back({pose.x, pose.y});
      picture.line(points, colour, 3, false);
      picture.line(outline(drive.trace.back(), scenario), colour, 2, true);
      if (index == 1) picture.arrow(drive.goal, 20, {0.13, 0.16, 0.22, 1});
    }
  }
  if (!scenario.walkers.empty()) key.emplace_back("people, when one is nearest to the robot", person_rim);
  picture.arrow(scenario.start, 20, {0.13, 0.16, 0.22, 1});
  picture.key(scenario.name, scenario.summary, key);
  picture.save(std::filesystem::path(folder) / (scenario.name + ".png"));
}

}  // namespace slalom::tools
