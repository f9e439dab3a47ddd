// The results of an evaluation: summary.json, and tables in the terminal.
#include <thread>

#include "json/json.hpp"
#include "slalom/core/version.hpp"
#include "tools/command_line/words.hpp"
#include "tools/evaluation/build_id.hpp"
#include "tools/evaluation/comparison.hpp"
#include "tools/evaluation/evaluation_job.hpp"
#include "tools/terminal/text_table.hpp"

namespace slalom::tools {
namespace {

using namespace evaluation;

/// A share, or null of nothing.
Json share_json(int part, int whole) {
  return whole > 0 ? Json(static_cast<double>(part) / whole) : Json(nullptr);
}

/// The sums and means of the figures, and the rates that follow from them.
Json tracking_json(const TrackingFigures& t, int laps) {
  Json json{{"detection_rate", share_json(t.detected, t.in_view)},
            {"long_detection_rate", share_json(t.long_detected, t.long_in_view)},
            {"false_objects_per_lap", share_json(t.false_objects, laps)}};
  json.update(figures_json(t));
  return json;
}
Json overtaking_json(const OvertakingFigures& o) {
  const int decided = o.overtaken + o.not_overtaken;
  Json json{
      {"overtaken_rate", share_json(o.overtaken, decided)},
      {"overtaken_rate_ci",
       interval_json(decided > 0 ? std::optional(wilson_interval(o.overtaken, decided)) : std::nullopt)}};
  json.update(figures_json(o));
  return json;
}

PairedComparison swapped(PairedComparison c) {
  std::swap(c.a, c.b);
  std::swap(c.only_a_succeeds, c.only_b_succeeds);
  c.ms_difference = -c.ms_difference;
  c.time_difference = -c.time_difference;
  return c;
}

/// The numbers of laps, separated by commas.
std::string listed(const std::vector<int>& laps) {
  std::string text;
  for (const int lap : laps) text += (text.empty() ? "" : ", ") + std::to_string(lap);
  return text;
}

void print_tracking(const std::string& label, const TrackingFigures& t, int laps, std::FILE* out) {
  const auto percent = [](int part, int whole) { return whole > 0 ? 100.0 * part / whole : 0.0; };
  std::fprintf(out,
               "%s: of cars in view within 8 m %.2f %% detected, after 0.2 s in view %.2f %%; %.2f false "
               "objects a lap; error %.3f m, %.2f m/s, %.3f rad (root mean square); update p99 %.2f ms\n",
               label.c_str(), percent(t.detected, t.in_view), percent(t.long_detected, t.long_in_view),
               static_cast<double>(t.false_objects) / std::max(laps, 1), t.position_error, t.speed_error,
               t.yaw_error, t.update_p99);
}

/// Names the laps in which a collision could not be avoided. Laps of the same number have the same obstacles:
/// those of one experiment speak for all.
void print_hopeless_laps(const Evaluated& evaluated, std::FILE* out) {
  if (evaluated.results.empty()) return;
  const std::vector<int> begun = evaluated.laps_begun_in_contact(evaluated.results.front().experiment);
  if (!begun.empty())
    std::fprintf(out,
                 "an obstacle stands where the car starts, in laps %s; no driver avoids these collisions\n",
                 listed(begun).c_str());
}

}  // namespace

std::vector<PairedComparison> Evaluated::comparisons() const {
  std::vector<PairedComparison> pairs = compare_pairs(rows, evaluation.experiments);
  const Json settings = parse_json(evaluation.settings);
  for (PairedComparison& c : pairs)
    if (!same_weights(settings, experiment(c.a), settings, experiment(c.b))) c.ms_p.reset();
  return pairs;
}

std::vector<PairedComparison> Evaluated::against_reference() const {
  const auto reference_of = [&](const std::string& scenario) {
    int first = -1;
    for (int i = 0; i < std::ssize(evaluation.experiments); ++i) {
      if (experiment(i).scenario != scenario) continue;
      if (experiment(i).method == "svg_mppi" && experiment(i).set.empty()) return i;
      if (first < 0) first = i;
    }
    return first;
  };
  std::vector<PairedComparison> pairs;
  for (const PairedComparison& c : comparisons()) {
    const int reference = reference_of(experiment(c.a).scenario);
    if (c.a == reference) pairs.push_back(swapped(c));
    if (c.b == reference) pairs.push_back(c);
  }
  return pairs;
}

std::vector<int> Evaluated::laps_begun_in_contact(int index) const {
  std::vector<int> laps;
  for (const LapRow& row : rows)
    if (row.experiment == index && began_in_contact(row, evaluation.environment->start))
      laps.push_back(row.lap);
  return laps;
}

Json Evaluated::summary() const {
  Json list = Json::array(), pairs = Json::array();
  for (const ExperimentResult& r : results) {
    const Experiment& e = experiment(r.experiment);
    Json result{{"method", e.method},
                {"set", e.set_text()},
                {"scenario", e.scenario},
                {"obstacles", e.obstacles},
                {"began_in_contact", laps_begun_in_contact(r.experiment).size()}};
    result.update(result_json(r));
    if (r.tracking) result["tracking"] = tracking_json(*r.tracking, r.laps);
    if (r.overtaking) result["overtaking"] = overtaking_json(*r.overtaking);
    list.push_back(std::move(result));
  }
  for (const PairedComparison& c : comparisons()) {
    Json pair{{"scenario", experiment(c.a).scenario},
              {"a", experiment(c.a).label()},
              {"b", experiment(c.b).label()}};
    pair.update(comparison_json(c));
    pairs.push_back(std::move(pair));
  }
  return {{"program", std::string("slalom ") + version()},
          {"build", build_id()},
          {"settings", parse_json(evaluation.settings)},
          {"machine", {{"cores", std::thread::hardware_concurrency()}, {"cpu", processor_name()}}},
          {"results", list},
          {"comparisons", pairs}};
}

TextTable results_table(const Evaluated& evaluated) {
  TextTable table({"<method", "<scenario", "laps", "success, %", "collisions", "collision rate, %",
                   "lap time, s", "MS", "solve, ms"});
  for (const ExperimentResult& r : evaluated.results) {
    const Experiment& e = evaluated.experiment(r.experiment);
    table.add({e.label(), e.scenario, std::to_string(r.laps), number_cell(100 * r.success_rate, 1),
               std::to_string(r.collisions), rate_cell(r.collision_rate, r.collision_rate_ci),
               mean_cell(r.time_mean, r.time_ci, r.finished), mean_cell(r.ms_mean, r.ms_ci, r.laps),
               number_cell(r.solve_p50)});
  }
  return table;
}

TextTable pairs_table(const Evaluated& evaluated) {
  TextTable table({"<paired by lap", "<scenario", "laps", "only one succeeds", "<p", "<collisions, p",
                   "lap time, s", "<p", "MS", "<p", "<compared with"});
  for (const PairedComparison& c : evaluated.against_reference()) {
    const Experiment &e = evaluated.experiment(c.a), &reference = evaluated.experiment(c.b);
    table.add({e.label(), e.scenario, std::to_string(c.laps),
               formatted("%d : %d", c.only_a_succeeds, c.only_b_succeeds), p_text(c.success_p),
               p_text(c.collisions_p), formatted("%+.3f", c.time_difference), p_text(c.time_p),
               formatted("%+.3f", c.ms_difference), p_text(c.ms_p), reference.label()});
  }
  return table;
}

void print_results(const Evaluated& evaluated, std::FILE* out) {
  results_table(evaluated).print(out);
  std::fprintf(
      out,
      "lap time: of finished laps. MS: mean cost of the control sequences sent in a lap, lower is better. In "
      "brackets: 95 %% intervals, from %d laps on. Solve: median over a lap.\n",
      fewest_laps);
  if (const TextTable pairs = pairs_table(evaluated); !pairs.empty()) {
    std::fprintf(out, "\n");
    pairs.print(out);
    const auto all = evaluated.against_reference();
    if (std::any_of(all.begin(), all.end(), [](const auto& c) { return !c.ms_p; }))
      std::fprintf(out, "MS is not tested where the weights of the two differ.\n");
  }
  for (const ExperimentResult& r : evaluated.results)
    if (r.tracking) print_tracking(evaluated.experiment(r.experiment).label(), *r.tracking, r.laps, out);
  for (const ExperimentResult& r : evaluated.results) {
    if (!r.overtaking) continue;
    const OvertakingFigures& o = *r.overtaking;
    std::fprintf(
        out,
        "%s: opponents: %d met, %d overtaken (mean time %.1f s), %d not overtaken; %d contacts, %d caused by "
        "the car; %d changes of side\n",
        evaluated.experiment(r.experiment).label().c_str(), o.met, o.overtaken, o.duration, o.not_overtaken,
        o.contacts, o.caused, o.side_changes);
  }
  print_hopeless_laps(evaluated, out);
}

}  // namespace slalom::tools
