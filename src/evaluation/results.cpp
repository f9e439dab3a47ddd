#include "slalom/evaluation/results.hpp"

#include <map>

namespace slalom::evaluation {

std::vector<const LapRow*> rows_of(const std::vector<LapRow>& rows, int experiment) {
  std::vector<const LapRow*> found;
  for (const LapRow& row : rows) {
    if (row.experiment == experiment) found.push_back(&row);
  }
  std::sort(found.begin(), found.end(), [](const LapRow* a, const LapRow* b) { return a->lap < b->lap; });
  return found;
}

namespace {

template <class Value>
std::vector<double> column(const std::vector<const LapRow*>& rows, Value&& value) {
  std::vector<double> values;
  values.reserve(rows.size());
  for (const LapRow* row : rows) values.push_back(static_cast<double>(value(*row)));
  return values;
}

/// The times of finished laps, s.
std::vector<double> finish_times(const std::vector<const LapRow*>& rows) {
  std::vector<double> times;
  for (const LapRow* row : rows)
    if (row->finished) times.push_back(row->time);
  return times;
}

TrackingFigures summarise_tracking(const std::vector<const LapRow*>& rows) {
  TrackingFigures total;
  for (const LapRow* row : rows) {
    const TrackingFigures& lap = row->tracking;
    total.in_view += lap.in_view;
    total.detected += lap.detected;
    total.long_in_view += lap.long_in_view;
    total.long_detected += lap.long_detected;
    total.false_objects += lap.false_objects;
    total.position_error += lap.detected * lap.position_error * lap.position_error;
    total.speed_error += lap.detected * lap.speed_error * lap.speed_error;
    total.yaw_error += lap.detected * lap.yaw_error * lap.yaw_error;
    total.update_p99 += lap.update_p99 / static_cast<double>(rows.size());
  }
  for (double* error : {&total.position_error, &total.speed_error, &total.yaw_error})
    *error = total.detected > 0 ? std::sqrt(*error / total.detected) : 0;
  return total;
}

OvertakingFigures summarise_overtaking(const std::vector<const LapRow*>& rows) {
  OvertakingFigures total;
  for (const LapRow* row : rows) {
    const OvertakingFigures& lap = row->overtaking;
    total.met += lap.met;
    total.overtaken += lap.overtaken;
    total.not_overtaken += lap.not_overtaken;
    total.duration += lap.overtaken * lap.duration;
    total.contacts += lap.contacts;
    total.caused += lap.caused;
    total.side_changes += lap.side_changes;
  }
  total.duration /= std::max(total.overtaken, 1);
  return total;
}

ExperimentResult summarise_one(const std::vector<const LapRow*>& rows, int index,
                               const Experiment& experiment) {
  ExperimentResult r{.experiment = index, .laps = static_cast<int>(rows.size())};
  if (rows.empty()) return r;
  int successes = 0;
  for (const LapRow* row : rows) {
    r.finished += row->finished;
    r.timeouts += row->timeout;
    r.collisions += row->collisions;
    successes += row->success;
    r.solve_max = std::max(r.solve_max, row->solve_max);
  }
  const auto ms = column(rows, [](const LapRow& row) { return row.mean_sequence_cost(); });
  r.ms_mean = mean(ms);
  r.ms_ci = bootstrap_mean(ms);
  r.state_cost_mean = mean(column(rows, [](const LapRow& row) { return row.state_cost; }));
  r.collision_cost_mean = mean(column(rows, [](const LapRow& row) { return row.collision_cost; }));
  r.solve_mean = mean(column(rows, [](const LapRow& row) { return row.solve_mean; }));
  r.solve_p50 = mean(column(rows, [](const LapRow& row) { return row.solve_p50; }));
  r.solve_p99 = mean(column(rows, [](const LapRow& row) { return row.solve_p99; }));
  const std::vector<double> times = finish_times(rows);
  r.time_mean = mean(times);
  r.time_ci = bootstrap_mean(times);
  r.success_rate = static_cast<double>(successes) / r.laps;
  r.success_rate_ci = wilson_interval(successes, r.laps);
  if (experiment.obstacles > 0) {
    const std::int64_t chances = static_cast<std::int64_t>(experiment.obstacles) * r.laps;
    r.collision_rate = static_cast<double>(r.collisions) / static_cast<double>(chances);
    r.collision_rate_ci = wilson_interval(r.collisions, chances);
    const auto contacts = column(rows, [](const LapRow& row) { return row.collisions; });
    const std::vector<double> obstacles(rows.size(), experiment.obstacles);
    r.collision_rate_bootstrap_ci = bootstrap_ratio(contacts, obstacles);
  }
  if (experiment.tracks()) r.tracking = summarise_tracking(rows);
  if (experiment.has_opponents()) r.overtaking = summarise_overtaking(rows);
  return r;
}

Comparison compare_paired(const std::vector<const LapRow*>& a, const std::vector<const LapRow*>& b) {
  Comparison c;
  std::map<int, const LapRow*> by_lap;
  for (const LapRow* row : b) by_lap[row->lap] = row;
  std::vector<double> ms, times, collisions;
  for (const LapRow* row : a) {
    const auto found = by_lap.find(row->lap);
    if (found == by_lap.end()) continue;
    const LapRow& other = *found->second;
    ms.push_back(row->mean_sequence_cost() - other.mean_sequence_cost());
    if (row->finished && other.finished) times.push_back(row->time - other.time);
    collisions.push_back(row->collisions - other.collisions);
    c.only_a_succeeds += row->success && !other.success;
    c.only_b_succeeds += !row->success && other.success;
  }
  c.laps = static_cast<int>(ms.size());
  c.ms_difference = mean(ms);
  c.ms_p = wilcoxon_p(ms);
  c.time_difference = mean(times);
  c.time_p = wilcoxon_p(times);
  c.success_p = mcnemar_p(c.only_a_succeeds, c.only_b_succeeds);
  c.collisions_p = wilcoxon_p(collisions);
  return c;
}

}  // namespace

Comparison compare_laps(const std::vector<const LapRow*>& a, std::int64_t obstacles_a,
                        const std::vector<const LapRow*>& b, std::int64_t obstacles_b, bool paired) {
  if (paired) return compare_paired(a, b);
  const auto costs = [](const auto& rows) {
    return column(rows, [](const LapRow& row) { return row.mean_sequence_cost(); });
  };
  const auto sum = [](const auto& rows, auto value) {
    std::int64_t total = 0;
    for (const LapRow* row : rows) total += value(*row);
    return total;
  };
  const auto successes = [&](const auto& rows) {
    return sum(rows, [](const LapRow& row) { return row.success; });
  };
  const auto collisions = [&](const auto& rows) {
    return sum(rows, [](const LapRow& row) { return row.collisions; });
  };
  const std::vector<double> costs_a = costs(a), costs_b = costs(b), times_a = finish_times(a),
                            times_b = finish_times(b);
  return {.paired = false,
          .laps = static_cast<int>(a.size() + b.size()),
          .ms_difference = mean(costs_a) - mean(costs_b),
          .ms_p = bootstrap_difference_p(costs_a, costs_b),
          .time_difference = mean(times_a) - mean(times_b),
          .time_p = bootstrap_difference_p(times_a, times_b),
          .success_p = fisher_p(successes(a), std::ssize(a), successes(b), std::ssize(b)),
          .collisions_p = fisher_p(collisions(a), obstacles_a, collisions(b), obstacles_b)};
}

std::vector<ExperimentResult> summarise(const std::vector<LapRow>& rows,
                                        const std::vector<Experiment>& experiments) {
  std::vector<ExperimentResult> results;
  for (int e = 0; e < static_cast<int>(experiments.size()); ++e) {
    results.push_back(summarise_one(rows_of(rows, e), e, experiments[static_cast<std::size_t>(e)]));
  }
  return results;
}

std::vector<PairedComparison> compare_pairs(const std::vector<LapRow>& rows,
                                            const std::vector<Experiment>& experiments) {
  std::vector<PairedComparison> comparisons;
  const int count = static_cast<int>(experiments.size());
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      const Experiment &ea = experiments[static_cast<std::size_t>(a)],
                       &eb = experiments[static_cast<std::size_t>(b)];
      if (ea.scenario != eb.scenario || ea.obstacles != eb.obstacles) continue;
      comparisons.push_back({compare_paired(rows_of(rows, a), rows_of(rows, b)), a, b});
    }
  }
  return comparisons;
}

}  // namespace slalom::evaluation
