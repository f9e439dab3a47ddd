#include "slalom/evaluation/lap_table.hpp"

#include <charconv>
#include <cstdio>
#include <numeric>
#include <set>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "slalom/evaluation/statistics.hpp"

namespace slalom::evaluation {

namespace {

/// Calls `visit(field, Figure)` for every column after `lap`, in order.
template <class Row, class Visit>
void visit_columns(Row& row, const std::vector<Experiment>& experiments, Visit&& visit) {
  const auto any = [&](bool (Experiment::*has)() const) {
    return std::any_of(experiments.begin(), experiments.end(),
                       [&](const Experiment& e) { return (e.*has)(); });
  };
  visit_row(row, visit);
  if (any(&Experiment::tracks)) visit_figures(row.tracking, visit);
  if (any(&Experiment::has_opponents)) visit_figures(row.overtaking, visit);
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

template <class Value>
std::string cell_of(const Value& value) {
  if constexpr (std::is_same_v<Value, std::string>) {
    return value;
  } else if constexpr (std::is_same_v<Value, bool>) {
    return value ? "1" : "0";
  } else {
    return text_of(value);
  }
}

template <class Value>
void parse_cell(const std::string& text, const std::string& column, Value& value) {
  if constexpr (std::is_same_v<Value, std::string>) {
    value = text;
  } else if constexpr (std::is_same_v<Value, bool>) {
    if (text != "0" && text != "1") throw std::invalid_argument(column + ": '" + text + "' must be 0 or 1");
    value = text == "1";
  } else {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || text.empty())
      throw std::invalid_argument(column + ": '" + text + "' must be a number");
    if constexpr (std::is_floating_point_v<Value>) {
      // Without a wall the clearance is infinite. All others must be finite, since their means are computed.
      const bool may_be_infinite = column == "min_clearance" && std::isinf(value) && value > 0;
      if (!std::isfinite(value) && !may_be_infinite)
        throw std::invalid_argument(column + ": '" + text + "' must be a finite number");
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
  auto times = result.solve_ms;
  std::sort(times.begin(), times.end());
  if (!times.empty()) {
    r.solve_mean = std::accumulate(times.begin(), times.end(), 0.0) / static_cast<double>(times.size());
    r.solve_max = times.back();
    r.solve_p50 = percentile(times, 0.5);
    r.solve_p99 = percentile(times, 0.99);
  }
  r.blocked_steps = result.planner_status[static_cast<std::size_t>(vehicle::PlannerStatus::blocked)];
  r.degenerate_steps =
      result.planner_status[static_cast<std::size_t>(vehicle::PlannerStatus::solver_degenerate)];
  for (const Collision& collision : result.first_collisions) {
    char point[64];
    std::snprintf(point, sizeof point, "%s%.3f:%.3f", r.collision_points.empty() ? "" : " ", collision.pose.x,
                  collision.pose.y);
    r.collision_points += point;
  }
  r.wall_time = wall_time;
  r.tracking = result.tracking;
  if (!result.tracking.update_ms.empty()) r.tracking.update_p99 = percentile(result.tracking.update_ms, 0.99);
  r.overtaking = figures_of(result.overtaking);
  return r;
}

bool began_in_contact(const LapRow& row, const maps::Pose& start) {
  const char *const begin = row.collision_points.data(), *const end = begin + row.collision_points.size();
  maps::Point first;
  const auto x = std::from_chars(begin, end, first.x);
  if (x.ec != std::errc() || x.ptr == end || *x.ptr != ':') return false;
  const auto y = std::from_chars(x.ptr + 1, end, first.y);
  return y.ec == std::errc() && std::hypot(first.x - start.x, first.y - start.y) < 0.05;
}

std::string csv_header(const std::vector<Experiment>& experiments) {
  std::string header = "method,scenario,set,lap";
  const LapRow row;
  visit_columns(row, experiments,
                [&](const auto&, const Figure& figure) { header.append(",").append(figure.name); });
  return header;
}

std::string csv_line(const LapRow& row, const std::vector<Experiment>& experiments) {
  const Experiment& e = experiments.at(static_cast<std::size_t>(row.experiment));
  std::string line = e.method + "," + e.scenario + "," + e.set_text() + "," + std::to_string(row.lap);
  visit_columns(row, experiments,
                [&](const auto& value, const Figure&) { line.append(",").append(cell_of(value)); });
  return line;
}

bool same_lap(const LapRow& a, const LapRow& b, const std::vector<Experiment>& experiments) {
  const auto repeatable = [&](const LapRow& row) {
    std::string cells;
    visit_columns(row, experiments, [&](const auto& value, const Figure& figure) {
      if (!figure.wall_clock) cells.append(cell_of(value)).append(",");
    });
    return cells;
  };
  return repeatable(a) == repeatable(b);
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
  visit_columns(row, experiments, [&](auto&, const Figure&) { ++columns; });
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
                [&](auto& value, const Figure& figure) { parse_cell(cells[i++], figure.name, value); });
  return row;
}

namespace {

/// Parses a line of a stored table. Throws std::invalid_argument if it is damaged or of another lap's seed.
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
      if (number == 1 && line != header)
        throw std::invalid_argument("the columns must be " + header +
                                    ". A folder of another version of the program is read by that version "
                                    "alone: drive the laps again");
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
