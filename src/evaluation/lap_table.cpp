#include "slalom/evaluation/lap_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <set>
#include <type_traits>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "slalom/evaluation/statistics.hpp"

namespace slalom::evaluation {

namespace {

/// Visits every column after `lap` with its name and field, in order, for the header, writing and reading.
template <class Row, class Visit>
void visit_columns(Row& r, const std::vector<Experiment>& experiments, Visit&& visit) {
  visit("seed", r.seed);
  visit("success", r.success);
  visit("collision", r.collisions);
  visit("timeout", r.timeout);
  visit("state_cost", r.state_cost);
  visit("collision_cost", r.collision_cost);
  visit("input_error", r.input_error);
  visit("mean_calculation_time", r.mean_calculation_time);
  visit("max_calculation_time", r.max_calculation_time);
  visit("min_calculation_time", r.min_calculation_time);
  visit("lap_time", r.time);
  visit("finished", r.finished);
  visit("steps", r.steps);
  visit("contacts", r.collided_bodies);
  visit("wall", r.wall);
  visit("impassable", r.impassable);
  visit("minimum_clearance", r.min_clearance);
  visit("mean_speed", r.mean_speed);
  visit("mean_path_distance", r.mean_path_distance);
  visit("max_path_distance", r.max_path_distance);
  visit("mean_variance", r.mean_variance);
  visit("mean_effective_samples", r.mean_effective_samples);
  visit("blocked_steps", r.blocked_steps);
  visit("degenerate_steps", r.degenerate_steps);
  visit("contact_points", r.contact_points);
  visit("solve_p50", r.solve_p50);
  visit("solve_p99", r.solve_p99);
  visit("wall_time", r.wall_time);
  if (std::any_of(experiments.begin(), experiments.end(), [](const Experiment& e) { return e.tracks(); })) {
    visit("tracking_in_view", r.tracking.in_view);
    visit("tracking_detected", r.tracking.detected);
    visit("tracking_long_in_view", r.tracking.long_in_view);
    visit("tracking_long_detected", r.tracking.long_detected);
    visit("tracking_false", r.tracking.false_objects);
    visit("tracking_position_error", r.tracking.position_error);
    visit("tracking_speed_error", r.tracking.speed_error);
    visit("tracking_yaw_error", r.tracking.yaw_error);
    visit("wall_tracking_p99", r.tracking.update_p99);
  }
  if (std::none_of(experiments.begin(), experiments.end(),
                   [](const Experiment& e) { return e.has_opponents(); }))
    return;
  visit("opponents_met", r.overtaking.met);
  visit("overtaken", r.overtaking.overtaken);
  visit("not_overtaken", r.overtaking.not_overtaken);
  visit("overtaking_time", r.overtaking.duration);
  visit("opponent_contacts", r.overtaking.contacts);
  visit("contacts_caused", r.overtaking.caused);
  visit("side_changes", r.overtaking.side_changes);
}

constexpr const char* checksum_column = "checksum";

/// Whether an experiment gives an option another value than this.
bool sets_other_than(const Experiment& experiment, std::string_view key, std::string_view value) {
  return std::any_of(experiment.set.begin(), experiment.set.end(),
                     [&](const auto& each) { return each.first == key && each.second != value; });
}

std::uint32_t row_hash(std::string_view line) {
  std::uint32_t hash = 2166136261U;
  for (const char c : line) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
  return hash;
}

template <class Number>
std::string text_of(Number value) {
  char buffer[40];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

template <class Field>
void parse_cell(const std::string& text, const char* column, Field& field) {
  if constexpr (std::is_same_v<Field, std::string>) {
    field = text;
  } else if constexpr (std::is_same_v<Field, bool>) {
    if (text != "0" && text != "1")
      throw std::invalid_argument(std::string(column) + ": '" + text + "' must be 0 or 1");
    field = text == "1";
  } else {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), field);
    if (error != std::errc{} || end != text.data() + text.size() || text.empty()) {
      throw std::invalid_argument(std::string(column) + ": '" + text + "' must be a number");
    }
    if constexpr (std::is_floating_point_v<Field>) {
      // Without a wall the clearance is infinite. All other values must be finite, since their means are
      // computed.
      const bool may_be_infinite =
          std::string_view(column) == "minimum_clearance" && std::isinf(field) && field > 0;
      if (!std::isfinite(field) && !may_be_infinite)
        throw std::invalid_argument(std::string(column) + ": '" + text + "' must be a finite number");
    }
  }
}

OvertakingFigures figures_of(const OvertakingRecord& record) {
  OvertakingFigures figures{.met = static_cast<int>(record.encounters.size()),
                            .contacts = record.contacts,
                            .caused = record.caused};
  for (const Encounter& each : record.encounters) {
    figures.side_changes += each.side_changes;
    figures.not_overtaken += each.end == EncounterEnd::not_overtaken;
    if (each.end != EncounterEnd::overtaken) continue;
    ++figures.overtaken;
    figures.duration += each.duration;
  }
  figures.duration /= std::max(figures.overtaken, 1);
  return figures;
}

constexpr std::size_t identity_columns = 4;  // method, scenario, set, lap

}  // namespace

std::string Experiment::set_text() const {
  std::string text;
  for (const auto& [key, value] : set) text += (text.empty() ? "" : " ") + key + "=" + value;
  std::replace(text.begin(), text.end(), ',', ';');
  return text;
}

std::string Experiment::label() const {
  const std::string text = set_text();
  return text.empty() ? method : method + " " + text;
}

bool Experiment::tracks() const {
  return sets_other_than(*this, "world.tracking", "off") &&
         sets_other_than(*this, "world.tracking", "automatic");
}

bool Experiment::has_opponents() const {
  return sets_other_than(*this, "world.opponents", "0");
}

bool Experiment::has_planning_opponents() const {
  return sets_other_than(*this, "world.planning_opponents", "0");
}

LapRow make_row(int experiment, int lap, const LapResult& result, double wall_time) {
  LapRow r;
  static_cast<LapFigures&>(r) = result;
  r.experiment = experiment;
  r.lap = lap;
  r.success = result.finished && result.collisions == 0;
  auto times = result.solve_ms;
  std::sort(times.begin(), times.end());
  if (!times.empty()) {
    r.mean_calculation_time =
        std::accumulate(times.begin(), times.end(), 0.0) / static_cast<double>(times.size());
    r.min_calculation_time = times.front();
    r.max_calculation_time = times.back();
    r.solve_p50 = percentile(times, 0.5);
    r.solve_p99 = percentile(times, 0.99);
  }
  r.blocked_steps = result.planner_status[static_cast<std::size_t>(vehicle::PlannerStatus::blocked)];
  r.degenerate_steps =
      result.planner_status[static_cast<std::size_t>(vehicle::PlannerStatus::solver_degenerate)];
  for (const Collision& collision : result.first_collisions) {
    char point[64];
    std::snprintf(point, sizeof point, "%s%.3f:%.3f", r.contact_points.empty() ? "" : " ", collision.pose.x,
                  collision.pose.y);
    r.contact_points += point;
  }
  r.wall_time = wall_time;
  r.tracking = result.tracking;
  if (!result.tracking.update_ms.empty()) r.tracking.update_p99 = percentile(result.tracking.update_ms, 0.99);
  r.overtaking = figures_of(result.overtaking);
  return r;
}

bool began_in_contact(const LapRow& row, const maps::Pose& start) {
  const char *const begin = row.contact_points.data(), *const end = begin + row.contact_points.size();
  maps::Point first;
  const auto x = std::from_chars(begin, end, first.x);
  if (x.ec != std::errc() || x.ptr == end || *x.ptr != ':') return false;
  const auto y = std::from_chars(x.ptr + 1, end, first.y);
  return y.ec == std::errc() && std::hypot(first.x - start.x, first.y - start.y) < 0.05;
}

std::string csv_header(const std::vector<Experiment>& experiments) {
  std::string header = "method,scenario,set,lap";
  const LapRow row;
  visit_columns(row, experiments, [&](const char* name, const auto&) { header.append(",").append(name); });
  return header;
}

std::string csv_line(const LapRow& row, const std::vector<Experiment>& experiments) {
  const Experiment& e = experiments.at(static_cast<std::size_t>(row.experiment));
  std::string line = e.method + "," + e.scenario + "," + e.set_text() + "," + std::to_string(row.lap);
  visit_columns(row, experiments, [&](const char*, const auto& field) {
    using Field = std::remove_cvref_t<decltype(field)>;
    line += ',';
    if constexpr (std::is_same_v<Field, std::string>) {
      line += field;
    } else if constexpr (std::is_same_v<Field, bool>) {
      line += field ? '1' : '0';
    } else {
      line += text_of(field);
    }
  });
  return line;
}

std::string checked_line(const std::string& line) {
  char digits[10];
  std::snprintf(digits, sizeof digits, ",%08x", static_cast<unsigned>(row_hash(line)));
  return line + digits;
}

std::string checked_header(const std::vector<Experiment>& experiments) {
  return csv_header(experiments) + "," + checksum_column;
}

LapRow parse_line(const std::string& line, const std::vector<Experiment>& experiments) {
  const auto cells = split(line);
  LapRow row;
  std::size_t columns = identity_columns;
  visit_columns(row, experiments, [&](const char*, auto&) { ++columns; });
  if (cells.size() != columns) {
    throw std::invalid_argument("has " + std::to_string(cells.size()) + " columns, must have " +
                                std::to_string(columns));
  }
  const auto found = std::find_if(experiments.begin(), experiments.end(), [&](const Experiment& e) {
    return e.method == cells[0] && e.scenario == cells[1] && e.set_text() == cells[2];
  });
  if (found == experiments.end()) throw std::invalid_argument("matches no experiment of this evaluation");
  row.experiment = static_cast<int>(found - experiments.begin());
  parse_cell(cells[3], "lap", row.lap);
  if (row.lap < 0 || row.lap >= found->laps)
    throw std::invalid_argument("lap: " + cells[3] + " must be in [0, " + std::to_string(found->laps - 1) +
                                "]");
  std::size_t i = identity_columns;
  visit_columns(row, experiments,
                [&](const char* name, auto& field) { parse_cell(cells[i++], name, field); });
  return row;
}

namespace {

/// Parses a line of a stored table. Throws std::invalid_argument if it is damaged or has the seed of another
/// lap.
LapRow parse_checked_line(const std::string& line, const std::vector<Experiment>& experiments,
                          std::uint64_t seed0) {
  const auto comma = line.rfind(',');
  const std::string text = line.substr(0, comma);
  if (comma == std::string::npos || checked_line(text) != line)
    throw std::invalid_argument("checksum: the row is damaged: it is not the row that was written");
  LapRow row = parse_line(text, experiments);
  const int obstacles = experiments[static_cast<std::size_t>(row.experiment)].obstacles;
  const std::uint64_t seed = lap_seed(seed0, row.lap, obstacles);
  if (row.seed == seed) return row;
  throw std::invalid_argument("seed: " + std::to_string(row.seed) + " must be " + std::to_string(seed) +
                              ", the seed of lap " + std::to_string(row.lap) + " with seed0 " +
                              std::to_string(seed0) + " and " + std::to_string(obstacles) + " obstacles");
}

}  // namespace

std::vector<LapRow> read_rows(const std::filesystem::path& file, const std::vector<Experiment>& experiments,
                              bool accept_truncated, std::uint64_t seed0) {
  constexpr std::uint64_t max_bytes = std::uint64_t{1} << 30;
  const std::string text = read_file(file, max_bytes), header = checked_header(experiments);
  if (text.empty() && !accept_truncated) throw IoError(file.string(), 1, "the header is missing");
  std::vector<LapRow> rows;
  std::set<std::pair<int, int>> seen;
  int number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    ++number;
    if (end == std::string::npos && accept_truncated) break;
    if (end == std::string::npos) throw IoError(file.string(), number, "is truncated");
    const std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    try {
      if (number == 1 && line != header) throw std::invalid_argument("the columns must be " + header);
      if (number == 1) continue;
      rows.push_back(parse_checked_line(line, experiments, seed0));
      if (!seen.insert({rows.back().experiment, rows.back().lap}).second)
        throw std::invalid_argument("duplicate lap");
    } catch (const std::invalid_argument& error) {
      throw IoError(file.string(), number, error.what());
    }
  }
  return rows;
}

}  // namespace slalom::evaluation
