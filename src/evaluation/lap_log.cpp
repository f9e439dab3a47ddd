#include "slalom/evaluation/lap_log.hpp"

#include <charconv>
#include <map>
#include <numeric>
#include <sstream>

#include "slalom/core/error.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/read_file.hpp"

namespace slalom::evaluation {

namespace {

constexpr std::uint64_t max_log_bytes = std::uint64_t{1} << 26;  // size of a file
constexpr std::size_t max_log_line = std::size_t{1} << 16;       // bytes
constexpr int max_log_laps = 1000000;
constexpr double max_log_value = 1e12;  // in magnitude; sums over all laps stay finite

/// A table of numbers, read line by line, by the names of its columns.
class NumberTable {
 public:
  explicit NumberTable(const std::filesystem::path& file)
      : file_(file.string()), text_(read_file(file, max_log_bytes)) {
    if (!next()) throw IoError(file_, 0, "is empty; the first line must name the columns");
    const auto names = std::move(cells_);
    for (std::size_t i = 0; i < names.size(); ++i)
      if (!columns_.emplace(names[i], i).second)
        throw IoError(file_, number_, "column '" + names[i] + "' is given twice");
    for (const char* needed : {"success", "collision", "state_cost", "collision_cost"})
      if (!has(needed)) throw IoError(file_, number_, "column " + std::string(needed) + " is missing");
  }

  /// Reads the next line that is not empty; false at the end of the text.
  bool next() {
    for (std::string line; std::getline(text_, line);) {
      ++number_;
      if (line.size() > max_log_line)
        throw IoError(file_, number_, "is longer than " + std::to_string(max_log_line) + " bytes");
      if (line.ends_with('\r')) line.pop_back();
      std::erase(line, ' ');
      if (line.empty()) continue;
      cells_.assign(1, "");
      for (const char c : line) {
        if (c == ',')
          cells_.emplace_back();
        else
          cells_.back() += c;
      }
      if (columns_.empty() || cells_.size() == columns_.size()) return true;
      throw IoError(file_, number_,
                    "has " + std::to_string(cells_.size()) + " columns, but the header has " +
                        std::to_string(columns_.size()));
    }
    return false;
  }

  bool has(const std::string& column) const { return columns_.contains(column); }

  double number(const std::string& column) const {
    const std::string& text = cells_[columns_.at(column)];
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
      throw IoError(file_, number_, column + ": '" + text + "' must be a finite number");
    if (std::abs(value) > max_log_value)
      throw IoError(file_, number_, column + ": '" + text + "' must be at most 1e12 in magnitude");
    return value;
  }

  int count(const std::string& column, int most) const {
    const double value = number(column);
    if (value < 0 || value > most || value != std::floor(value))
      throw IoError(file_, number_,
                    column + ": " + cells_[columns_.at(column)] + " must be a whole number in [0, " +
                        std::to_string(most) + "]");
    return saturate_cast<int>(value);
  }

 private:
  std::string file_;
  std::istringstream text_;
  std::map<std::string, std::size_t> columns_;
  std::vector<std::string> cells_;
  int number_ = 0;  ///< number of the last line
};

}  // namespace

LapLog read_lap_log(const std::filesystem::path& file) {
  NumberTable table(file);
  LapLog log{.file = file.string()};
  double solve_sum = 0, solve_max = 0;
  const bool timed = table.has("mean_calculation_time") && table.has("max_calculation_time");
  while (table.next()) {
    if (++log.laps > max_log_laps)
      throw IoError(log.file, 0, "has more than " + std::to_string(max_log_laps) + " laps");
    log.successes += table.count("success", 1);
    log.lap_collisions.push_back(table.count("collision", 100000));
    log.collisions += saturate_cast<std::int64_t>(log.lap_collisions.back());
    if (table.has("seed")) log.seeds.push_back(table.number("seed"));
    if (table.has("timeout")) log.timeouts += table.count("timeout", 1);
    log.ms.push_back(table.number("state_cost") + table.number("collision_cost"));
    if (!timed) continue;
    solve_sum += table.number("mean_calculation_time");
    solve_max = std::max(solve_max, table.number("max_calculation_time"));
  }
  if (log.laps == 0) throw IoError(log.file, 0, "contains no lap");
  if (timed) {
    log.solve_ms_mean = solve_sum / log.laps;
    log.solve_ms_max = solve_max;
  }
  return log;
}

Agreement LogComparison::ms_agreement() const {
  if (ms_p < 0.05) return Agreement::outside;
  const bool conclusive =
      std::min(our_laps, laps) >= enough_laps && ms_ratio_ci.high - ms_ratio_ci.low <= 2 * ms_half_width;
  return conclusive ? Agreement::inside : Agreement::undecided;
}

Agreement LogComparison::collision_agreement() const {
  if (!collision_p) return Agreement::inside;
  if (*collision_p < 0.05) return Agreement::outside;
  const bool conclusive = rate_difference_ci->high - rate_difference_ci->low <= 2 * rate_half_width;
  return conclusive ? Agreement::inside : Agreement::undecided;
}

Agreement LogComparison::agreement() const {
  const Agreement ms = ms_agreement(), contacts = collision_agreement();
  for (const Agreement worst : {Agreement::outside, Agreement::undecided})
    if (ms == worst || contacts == worst) return worst;
  return Agreement::inside;
}

namespace {

/// Returns the laps of a log with these seeds, in their order, or nothing unless it has all of them.
std::optional<LapLog> laps_with_seeds(const LapLog& log, const std::vector<LapRow>& rows) {
  LapLog laps;
  for (const LapRow& row : rows) {
    const auto found = std::find(log.seeds.begin(), log.seeds.end(), static_cast<double>(row.seed));
    if (found == log.seeds.end()) return {};
    const auto lap = static_cast<std::size_t>(found - log.seeds.begin());
    laps.ms.push_back(log.ms[lap]);
    laps.lap_collisions.push_back(log.lap_collisions[lap]);
    laps.collisions += saturate_cast<std::int64_t>(log.lap_collisions[lap]);
    ++laps.laps;
  }
  return laps;
}

std::vector<double> differences(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> result(a.size());
  std::transform(a.begin(), a.end(), b.begin(), result.begin(), std::minus<>());
  return result;
}

}  // namespace

LogComparison compare_with_log(const std::vector<LapRow>& rows, int obstacles, const LapLog& log) {
  std::vector<double> measured, collisions;
  for (const LapRow& row : rows) {
    measured.push_back(row.mean_sequence_cost());
    collisions.push_back(row.collisions);
  }
  const std::optional<LapLog> pairs = obstacles > 0 ? laps_with_seeds(log, rows) : std::nullopt;
  const LapLog& theirs = pairs ? *pairs : log;
  LogComparison c{.our_laps = static_cast<int>(measured.size()),
                  .laps = theirs.laps,
                  .paired = pairs.has_value(),
                  .ms_mean = mean(log.ms),
                  .ms_ci = bootstrap_mean(log.ms)};
  const double ms = mean(theirs.ms);
  c.ms_ratio = mean(measured) / ms;
  const Interval difference =
      c.paired ? bootstrap_mean(differences(measured, theirs.ms)) : bootstrap_difference(measured, theirs.ms);
  c.ms_ratio_ci = {1 + difference.low / ms, 1 + difference.high / ms};
  // With few laps the bootstrap misjudges their scatter.
  if (c.paired)
    c.ms_p = wilcoxon_p(differences(measured, theirs.ms));
  else if (std::min(c.our_laps, c.laps) >= LogComparison::enough_laps)
    c.ms_p = bootstrap_difference_p(measured, theirs.ms);
  else
    c.ms_p = permutation_difference_p(measured, theirs.ms);
  if (obstacles > 0) {
    const auto our_collisions =
        saturate_cast<std::int64_t>(std::accumulate(collisions.begin(), collisions.end(), 0.0));
    const std::int64_t our_chances = std::int64_t{obstacles} * c.our_laps,
                       chances = std::int64_t{obstacles} * c.laps, all = std::int64_t{obstacles} * log.laps;
    c.collision_rate = static_cast<double>(log.collisions) / static_cast<double>(all);
    c.collision_rate_ci = wilson_interval(log.collisions, all);
    c.rate_difference_ci = rate_difference_interval(our_collisions, our_chances, theirs.collisions, chances);
    c.collision_p = c.paired ? wilcoxon_p(differences(collisions, theirs.lap_collisions))
                             : fisher_p(our_collisions, our_chances, theirs.collisions, chances);
  }
  return c;
}

}  // namespace slalom::evaluation
