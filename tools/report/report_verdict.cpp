#include <algorithm>
#include <cmath>
#include <cstdio>

#include "src/evaluation/json.hpp"
#include "tools/report/report_text.hpp"

namespace slalom::tools {
namespace {

using namespace evaluation;

constexpr double significant = 0.05;  // level of the tests

/// The experiment of a scenario that the others are compared with: svg_mppi with its own options, else the
/// first. -1 without any.
int reference_of(const Report& report, const std::string& scenario) {
  int first = -1;
  for (const ReportRow& row : report.rows) {
    const Experiment& e = report.experiment(row);
    if (e.scenario != scenario) continue;
    if (e.method == "svg_mppi" && e.set.empty()) return row.experiment;
    if (first < 0) first = row.experiment;
  }
  return first;
}

std::string name_of(const Report& report, int experiment) {
  const auto row = std::find_if(report.rows.begin(), report.rows.end(),
                                [&](const ReportRow& r) { return r.experiment == experiment; });
  const auto& experiments = report.evaluated.evaluation.experiments;
  return row == report.rows.end() ? experiments[static_cast<std::size_t>(experiment)].label() : row->name;
}

/// A comparison of an experiment with the reference of its scenario. Differences are of the other one.
struct Compared {
  int reference = 0, other = 0, laps = 0;
  double ms_difference = 0, ms_p = 1, collision_p = 1, success_p = 1;
  int only_reference_succeeds = 0, only_other_succeeds = 0;
};

std::vector<Compared> comparisons(const Report& report) {
  const auto& experiments = report.evaluated.evaluation.experiments;
  const auto is_shown = [&](int experiment) {
    return std::any_of(report.rows.begin(), report.rows.end(),
                       [&](const ReportRow& r) { return r.experiment == experiment; });
  };
  std::vector<Compared> all;
  for (const PairedComparison& c : compare_pairs(report.evaluated.rows, experiments)) {
    const int reference = reference_of(report, experiments[static_cast<std::size_t>(c.a)].scenario);
    if ((c.a != reference && c.b != reference) || !is_shown(c.a) || !is_shown(c.b)) continue;
    const bool turned = c.b == reference;
    all.push_back({.reference = reference,
                   .other = turned ? c.a : c.b,
                   .laps = c.laps,
                   .ms_difference = turned ? c.ms_difference : -c.ms_difference,
                   .ms_p = c.ms_p,
                   .collision_p = c.collision_p,
                   .success_p = c.success_p,
                   .only_reference_succeeds = turned ? c.only_b_succeeds : c.only_a_succeeds,
                   .only_other_succeeds = turned ? c.only_a_succeeds : c.only_b_succeeds});
  }
  return all;
}

const ExperimentResult& result_of(const Report& report, int experiment) {
  return report.evaluated.results[static_cast<std::size_t>(experiment)];
}

std::string laps_text(int laps) {
  return std::to_string(laps) + (laps == 1 ? " lap" : " laps");
}

/// "62 % lower mean cost than mppi, p < 0.001"
std::string cost_sentence(const Report& report, const Compared& c) {
  const double ours = result_of(report, c.reference).ms_mean, theirs = result_of(report, c.other).ms_mean;
  const std::string than = " than " + escaped(name_of(report, c.other));
  if (!(theirs > 0) || !std::isfinite(ours)) return "mean cost not comparable with" + than.substr(5);
  const double change = 100 * (ours / theirs - 1);
  char share[32];
  std::snprintf(share, sizeof share, "%.*f %%", std::abs(change) < 9.95 ? 1 : 0, std::abs(change));
  std::string text = std::string(share) + (change < 0 ? " lower" : " higher") + " mean cost" + than;
  if (c.ms_p < significant) return text + ", p " + (c.ms_p < 0.001 ? "" : "= ") + p_value(c.ms_p);
  return text + ", not significant with " + laps_text(c.laps);
}

/// "; collisions 1.2 % and 4.0 %, p = 0.02"
std::string collision_sentence(const Report& report, const Compared& c) {
  const auto& ours = result_of(report, c.reference).collision_rate;
  const auto& theirs = result_of(report, c.other).collision_rate;
  if (!ours || !theirs) return {};
  std::string text = "; collisions " + number(100 * *ours, 1) + " % and " + number(100 * *theirs, 1) + " %";
  if (c.collision_p < significant)
    return text + ", p " + (c.collision_p < 0.001 ? "" : "= ") + p_value(c.collision_p);
  return text + ", not significant with " + laps_text(c.laps);
}

const char* scenario_name(const std::string& scenario) {
  return scenario == "oa" ? "Among obstacles" : "Path tracking";
}

}  // namespace

std::string verdict_html(const Report& report) {
  const auto& experiments = report.evaluated.evaluation.experiments;
  std::string text;
  for (const Compared& c : comparisons(report))
    text += std::string("<p>") + scenario_name(experiments[static_cast<std::size_t>(c.reference)].scenario) +
            ": <b>" + escaped(name_of(report, c.reference)) + "</b>: " + cost_sentence(report, c) +
            collision_sentence(report, c) + ".</p>\n";
  return text.empty() ? text : "<section class=\"verdict\"><h2>Result</h2>\n" + text + "</section>\n";
}

std::string paired_table(const Report& report) {
  const auto& experiments = report.evaluated.evaluation.experiments;
  std::string rows;
  for (const Compared& c : comparisons(report)) {
    rows += "<tr><td>" + escaped(name_of(report, c.other)) + "</td><td>" +
            escaped(name_of(report, c.reference)) + "</td><td>" +
            experiments[static_cast<std::size_t>(c.other)].scenario + "</td><td>" + std::to_string(c.laps) +
            "</td><td>" + number(c.ms_difference) + "</td><td>" + p_value(c.ms_p) + "</td><td>" +
            std::to_string(c.only_reference_succeeds) + "</td><td>" + std::to_string(c.only_other_succeeds) +
            "</td><td>" + p_value(c.success_p) + "</td></tr>\n";
  }
  if (rows.empty()) return {};
  return "<section><h2>Paired comparison</h2><p class=\"caption\">Both drive the same seeds and therefore "
         "the same obstacles. MS by Wilcoxon's signed-rank test, success (finished without collision) by "
         "McNemar's.</p><div class=\"scroll\"><table><thead><tr><th></th><th class=\"words\">compared "
         "with</th><th></th><th>laps</th><th>MS above it</th><th>p</th><th>only the other "
         "succeeds</th><th>only this one succeeds</th><th>p</th></tr></thead><tbody>\n" +
         rows + "</tbody></table></div></section>\n";
}

std::string glossary_html(const Report& report) {
  const bool obstacles = std::any_of(report.rows.begin(), report.rows.end(), [&](const ReportRow& row) {
    return report.experiment(row).scenario == "oa";
  });
  const bool timeouts = std::any_of(report.rows.begin(), report.rows.end(),
                                    [&](const ReportRow& row) { return report.result(row).timeouts > 0; });
  std::string html =
      "<section><h2>Terms</h2><p><b>MS</b>, the mean sequence cost, is the state and collision cost of the "
      "trajectory predicted for the control sequence sent, averaged over the control steps of a lap; "
      "intervals "
      "are bootstraps over laps.</p>";
  if (obstacles)
    html +=
        "<p>The <b>collision rate</b> is the number of collisions divided by the number of obstacles, with "
        "Wilson's interval. Collisions per lap are compared by Wilcoxon's signed-rank test.</p>";
  if (timeouts) html += "<p>Laps that <b>time out</b> count like all others.</p>";
  if (!report.references.empty())
    html +=
        "<p>A row <b>agrees</b> with laps of another program if at 5 % neither a two-sample bootstrap of MS "
        "(with fewer than 10 laps a permutation test) nor Fisher's exact test of collisions distinguishes "
        "them. The <b>log</b> has the authors' laps; the <b>paper's program</b> was also driven in this "
        "simulator.</p>";
  const auto settings = parse_json(report.evaluated.evaluation.settings);
  return html + "<details><summary>All settings</summary><pre>" + escaped(json_text(settings, 1)) +
         "</pre></details></section>\n";
}

}  // namespace slalom::tools
