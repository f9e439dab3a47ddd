#include <algorithm>
#include <utility>

#include "src/evaluation/json.hpp"
#include "tools/report/report_text.hpp"

namespace slalom::tools {
namespace {

using namespace evaluation;

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

}  // namespace

std::string paired_table(const Report& report) {
  const auto& experiments = report.evaluated.evaluation.experiments;
  const auto is_shown = [&](int experiment) {
    return std::any_of(report.rows.begin(), report.rows.end(),
                       [&](const ReportRow& r) { return r.experiment == experiment; });
  };
  std::string rows;
  for (PairedComparison c : compare_pairs(report.evaluated.rows, experiments)) {
    const std::string& scenario = experiments[static_cast<std::size_t>(c.a)].scenario;
    const int reference = reference_of(report, scenario);
    if ((c.a != reference && c.b != reference) || !is_shown(c.a) || !is_shown(c.b)) continue;
    if (c.a == reference) {  // the reference experiment is the second one of a row
      std::swap(c.a, c.b);
      std::swap(c.only_a_succeeds, c.only_b_succeeds);
      c.ms_difference = -c.ms_difference;
    }
    rows += "<tr><td>" + escaped(name_of(report, c.a)) + "</td><td>" + escaped(name_of(report, c.b)) +
            "</td><td>" + scenario + "</td><td>" + std::to_string(c.laps) + "</td><td>" +
            number(c.ms_difference) + "</td><td>" + p_value(c.ms_p) + "</td><td>" +
            std::to_string(c.only_b_succeeds) + "</td><td>" + std::to_string(c.only_a_succeeds) +
            "</td><td>" + p_value(c.success_p) + "</td><td>" + p_value(c.collision_p) + "</td></tr>\n";
  }
  if (rows.empty()) return {};
  return "<section><h2>Paired comparison</h2><p class=\"caption\">Both drive the same seeds and therefore "
         "the same obstacles. MS and collisions by Wilcoxon's signed-rank test, success (finished without "
         "collision) by McNemar's.</p><div class=\"scroll\"><table><thead><tr><th></th><th "
         "class=\"words\">compared with</th><th></th><th>laps</th><th>MS above it</th><th>p</th><th>only the "
         "other succeeds</th><th>only this one succeeds</th><th>p</th><th>collisions, p</th></tr></thead>"
         "<tbody>\n" +
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
