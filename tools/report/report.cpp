#include "tools/report/report.hpp"

#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "slalom/core/files/write_file.hpp"
#include "slalom/core/version.hpp"
#include "tools/drawing/row_chart.hpp"
#include "view/recording/encodings.hpp"

namespace slalom::tools {
namespace {

using namespace evaluation;

/// The style sheet: for screens of any width, in light and dark colours, and for paper.
constexpr const char* style = R"(
:root{color-scheme:light dark;--faint:#5a6478;--rule:#e3e7ee;--paper:#fff;--ground:#f3f5f9}
@media(prefers-color-scheme:dark){:root{--faint:#a3adbd;--rule:#303846;--paper:#171c24;--ground:#0e1218}img{filter:invert(.91) hue-rotate(180deg)}}
body{margin:0;background:var(--ground);font:15px/1.55 system-ui,sans-serif}
main{max-width:1320px;margin:0 auto;padding:20px 14px 60px}
p{max-width:92ch}
.faint,th{color:var(--faint)}
section{background:var(--paper);border:1px solid var(--rule);border-radius:12px;padding:16px 20px;margin-top:20px;overflow-x:auto}
.scroll{overflow-x:auto}
table{border-collapse:collapse;width:100%;font-size:14px;font-variant-numeric:tabular-nums}
th,td{text-align:right;padding:6px 10px;border-bottom:1px solid var(--rule);vertical-align:top;white-space:nowrap}
.words{text-align:left;white-space:normal}
img{max-width:100%;min-width:720px;display:block;margin:14px auto;background:#fff;border-radius:8px;padding:6px}
pre{overflow-x:auto;font-size:12.5px}
@media print{section{break-inside:avoid;border:0}}
)";

constexpr const char* terms =
    "MS, the mean sequence cost, is the state and collision cost of the trajectory predicted for the control "
    "sequence sent, averaged over the control steps of a lap; lower is better. The collision rate is the "
    "number of collisions divided by the number of obstacles. Intervals of 95 %: bootstraps over laps, and "
    "Wilson's of rates. Pairs drive the same seeds and therefore the same obstacles: MS, lap time and "
    "collisions by Wilcoxon's signed-rank test, success (finished without collision) by McNemar's.";
constexpr const char* reference_terms =
    "A row agrees with laps of another program if at 5 % neither a two-sample bootstrap of MS (with fewer "
    "than 10 laps a permutation test) nor Fisher's exact test of collisions distinguishes them. The log has "
    "the authors' laps; the paper's program was also driven in this simulator.";

/// The rate of collisions and its interval, in percent.
Marks rate_marks(const auto& figures) {
  return {{},
          Span{100 * *figures.collision_rate, 100 * figures.collision_rate_ci->low,
               100 * figures.collision_rate_ci->high}};
}

Drawing drawing_of(const Report& report, const ReportChart& chart) {
  const char* const axis = "mean sequence cost (MS) of a lap, lower is better";
  Panel tracking{.title = "Path tracking: cost", .axis = axis, .ours = {}, .theirs = {}};
  Panel obstacles{.title = "Obstacles: cost", .axis = axis, .ours = {}, .theirs = {}};
  Panel collisions{.title = "Obstacles: collisions",
                   .axis = "collision rate, %, with its 95 % interval",
                   .kind = Panel::Kind::bars,
                   .ours = {},
                   .theirs = {}};
  const bool compared = std::any_of(report.references.begin(), report.references.end(),
                                    [](const Reference& r) { return r.published.has_value(); });
  const auto add = [&](Panel& panel, const ExperimentResult* at, auto ours, auto theirs) {
    panel.ours.push_back(at ? ours(*at) : Marks{});
    if (!compared) return;
    const Reference* const other =
        at ? &report.references[static_cast<std::size_t>(at->experiment)] : nullptr;
    panel.theirs.push_back(other && other->published ? theirs(*other) : Marks{});
  };
  const auto our_cost = [&](const ExperimentResult& result) {
    Marks marks;
    for (const LapRow& lap : report.evaluated.rows)
      if (lap.experiment == result.experiment) marks.values.push_back(lap.mean_sequence_cost());
    return marks;
  };
  const auto their_cost = [](const Reference& r) { return Marks{r.log->ms, {}}; };
  const auto our_rate = [](const ExperimentResult& result) { return rate_marks(result); };
  const auto their_rate = [](const Reference& r) { return rate_marks(*r.published); };
  RowChart shown{
      .names = {},
      .panels = {},
      .title = chart.title,
      .note = "box: quartiles and median; diamond: mean; points: laps beyond 1.5 boxes; bars: 95 %",
      .their_key = compared ? "published laps" : ""};
  bool tracks = false, avoids = false;
  for (const ChartRow& row : chart.rows) {
    shown.names.push_back(row.name);
    add(tracking, row.tracking, our_cost, their_cost);
    add(obstacles, row.obstacles, our_cost, their_cost);
    add(collisions, row.obstacles, our_rate, their_rate);
    tracks |= row.tracking != nullptr;
    avoids |= row.obstacles != nullptr;
  }
  if (tracks) shown.panels.push_back(tracking);
  if (avoids) shown.panels.insert(shown.panels.end(), {obstacles, collisions});
  return draw_chart(shown);
}

std::string section(const std::string& title, const std::string& contents) {
  return "<section><h2>" + escaped(title) + "</h2>\n" + contents + "</section>\n";
}

}  // namespace

void write_report(const Report& report, const std::filesystem::path& folder) {
  const auto settings = parse_json(report.evaluated.evaluation.settings);
  const auto word = [&](const char* key) { return escaped(settings[key].get<std::string>()); };
  const std::string title = escaped(report.title);
  std::string html =
      "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>" +
      title + "</title><style>" + style + "</style><main>\n<h1>" + title + "</h1><p class=\"faint\">" +
      std::to_string(report.evaluated.rows.size()) + " laps on " + word("course") +
      " \xC2\xB7 configuration " + word("config") + " \xC2\xB7 evaluation " + word("evaluation") +
      " \xC2\xB7 slalom " + version() + "</p>\n";
  for (const std::string& note : report.notes) html += "<p>" + escaped(note) + "</p>\n";
  for (const auto& [name, table] : report.tables)
    if (!table.empty()) html += section(name, "<div class=\"scroll\">" + table.html() + "</div>\n");
  const std::filesystem::path figures = folder / "figures";
  std::error_code error;
  std::filesystem::create_directories(figures, error);
  if (error) throw IoError(figures.string(), 0, "cannot be created: " + error.message());
  for (const ReportChart& chart : report.charts) {
    const Drawing drawing = drawing_of(report, chart);
    for (const char* ending : {".svg", ".png"}) save(drawing, figures / (chart.file + ending));
    html +=
        section(chart.title, "<img alt=\"" + escaped(chart.title) + "\" src=\"data:image/svg+xml;base64," +
                                 view::base64(to_svg(drawing)) + "\">\n");
  }
  html +=
      section("Terms", std::string("<p>") + terms + "</p>" +
                           (report.references.empty() ? "" : std::string("<p>") + reference_terms + "</p>") +
                           "<details><summary>All settings</summary><pre>" + escaped(json_text(settings, 1)) +
                           "</pre></details>");
  write_file(folder / "report.html", html + "</main></html>\n");
}

}  // namespace slalom::tools
