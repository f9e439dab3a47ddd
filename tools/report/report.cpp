#include "tools/report/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>

#include "slalom/core/error.hpp"
#include "slalom/core/version.hpp"
#include "tools/json/json.hpp"
#include "view/recording/encodings.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using namespace evaluation;

constexpr const char* style = R"(
:root{--ink:#212938;--faint:#6b7589;--rule:#e3e7ee;--blue:#1f6bc7;--good:#1d7f4f;--bad:#b3541e;--paper:#fff}
*{box-sizing:border-box}
body{margin:0;background:#f3f5f9;color:var(--ink);font:15px/1.55 system-ui,"Segoe UI",Helvetica,Arial,sans-serif}
main{max-width:1320px;margin:0 auto;padding:36px 28px 80px}
h1{font-size:31px;line-height:1.2;margin:0 0 6px;letter-spacing:-.01em}
h2{font-size:21px;margin:0 0 4px}
h3{font-size:15px;margin:20px 0 6px;color:var(--faint);font-weight:600}
p{margin:6px 0;max-width:92ch}
.sub,.caption{color:var(--faint)}
.caption{font-size:13.5px}
section{background:var(--paper);border:1px solid var(--rule);border-radius:12px;padding:24px 26px;margin-top:22px}
.tiles{display:flex;flex-wrap:wrap;gap:14px;margin-top:22px}
.tile{flex:1 1 210px;background:var(--paper);border:1px solid var(--rule);border-radius:12px;padding:15px 18px}
.tile b{display:block;font-size:27px;line-height:1.25;font-variant-numeric:tabular-nums}
.tile span{color:var(--faint);font-size:13.5px}
.note{border-left:3px solid #e0a030;background:#fdf7e8;padding:8px 14px;border-radius:0 8px 8px 0;margin-top:14px}
.scroll{overflow-x:auto}
table{border-collapse:collapse;width:100%;font-size:14px;font-variant-numeric:tabular-nums}
th{font-weight:600;color:var(--faint);text-align:right;padding:6px 10px;border-bottom:2px solid var(--rule);font-size:13px;
white-space:nowrap}
td{text-align:right;padding:7px 10px;border-bottom:1px solid var(--rule);vertical-align:top;white-space:nowrap}
th:first-child,td:first-child{text-align:left;padding-left:0}
td.words,th.words{text-align:left}
tr.explained td{border-bottom:0;padding-bottom:1px}
tr.why td{text-align:left;white-space:normal;color:var(--faint);font-size:13px;padding:0 10px 8px 16px}
td small{color:var(--faint);font-size:12.5px}
@media(max-width:1300px){td small{display:block}th{white-space:normal;vertical-align:bottom}td:first-child{white-space:normal}}
.pill{display:inline-block;border-radius:99px;padding:0 9px;font-size:12.5px;font-weight:600;color:#fff;background:var(--faint)}
.inside{background:var(--good)}.outside{background:var(--bad)}
img{max-width:100%;max-height:1000px;display:block;margin:14px auto 6px}
details{margin-top:10px}summary{cursor:pointer;color:var(--blue)}
pre{overflow-x:auto;background:#f6f8fb;padding:12px;border-radius:8px;font-size:12.5px}
@media print{body{background:#fff}section{break-inside:avoid;border:0;padding:8px 0}}
)";

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else {
      out += c;
    }
  }
  return out;
}

std::string number(double value, int digits = 3) {
  if (!std::isfinite(value)) return "\xE2\x80\x93";
  char text[40];
  std::snprintf(text, sizeof text, "%.*f",
                value >= 100  ? 1
                : value >= 10 ? std::min(digits, 2)
                              : digits,
                value);
  return text;
}

/// A p-value (0 .. 1), a dash where there is none.
std::string p_value(double p) {
  return p < 0.001 ? "&lt; 0.001" : number(p);
}

std::string with_interval(double value, const Interval& i, double scale = 1, int digits = 3) {
  return number(scale * value, digits) + " <small>" + number(scale * i.low, digits) + " \xE2\x80\x93 " +
         number(scale * i.high, digits) + "</small>";
}

std::string rate_cell(const std::optional<double>& rate, const std::optional<Interval>& interval) {
  return rate ? with_interval(*rate, *interval, 100, 1) : "\xE2\x80\x93";
}

/// The kind of a verdict, and what it says beyond that.
std::pair<std::string, std::string> verdict_parts(const std::string& verdict) {
  const auto end = verdict.find_first_of(":;");
  if (end == std::string::npos) return {verdict, ""};
  return {verdict.substr(0, end), verdict.substr(std::min(verdict.size(), end + 2))};
}

std::string pill(const std::string& kind) {
  const std::string colour = kind == verdicts::log                                    ? "inside"
                             : kind == verdicts::neither || kind == verdicts::not_log ? "outside"
                                                                                      : "";
  return "<span class=\"pill " + colour + "\">" + escaped(kind) + "</span>";
}

const char* heading(const std::string& section) {
  if (section == "baseline") return "Comparison with the baselines";
  if (section == "ablation") return "Ablation: nominal sequence and adaptive covariance";
  if (section == "sweep") return "Nominal sequence with fixed covariances";
  return "Methods";
}

std::string table(const Report& report, const std::string& section, const std::string& scenario) {
  std::string rows;
  const bool obstacles = scenario == "oa", compared = !report.references.empty();
  for (const ReportRow& row : report.rows) {
    if (row.section != section || report.experiment(row).scenario != scenario) continue;
    const auto& r = report.result(row);
    const auto [kind, words] =
        compared ? verdict_parts(report.references[static_cast<std::size_t>(row.experiment)].verdict)
                 : std::pair<std::string, std::string>();
    const std::string why = words + (words.empty() || row.note.empty() ? "" : ". ") + row.note;
    rows += std::string(why.empty() ? "<tr>" : "<tr class=\"explained\">") + "<td>" + escaped(row.name) +
            "</td><td>" + std::to_string(r.laps) + "</td><td>" + with_interval(r.ms_mean, r.ms_ci) + "</td>";
    const Reference* reference = report.reference(row);
    const std::string none = "<td>\xE2\x80\x93</td>";
    if (compared)
      rows += reference ? "<td>" + with_interval(reference->published->ms_mean, reference->published->ms_ci) +
                              "</td><td>" +
                              (reference->released ? number(reference->released->ms_mean) : "\xE2\x80\x93") +
                              "</td>"
                        : none + none;
    if (obstacles) rows += "<td>" + rate_cell(r.collision_rate, r.collision_rate_ci) + "</td>";
    if (compared && obstacles)
      rows += reference ? "<td>" +
                              rate_cell(reference->published->collision_rate,
                                        reference->published->collision_rate_ci) +
                              "</td>"
                        : none;
    rows += "<td>" + number(100 * r.success_rate, 1) + "</td><td>" + number(r.lap_time_mean, 2) +
            "</td><td>" + std::to_string(r.timeouts) + "</td>";
    if (compared) rows += "<td class=\"words\">" + pill(kind) + "</td>";
    rows += "</tr>\n";
    if (!why.empty()) rows += "<tr class=\"why\"><td colspan=\"11\">" + escaped(why) + "</td></tr>\n";
  }
  if (rows.empty()) return {};
  std::string head = "<th></th><th>laps</th><th>MS (95 %)</th>";
  if (compared) head += "<th>published MS</th><th>paper's program, MS</th>";
  if (obstacles) head += "<th>collision rate, %</th>";
  if (compared && obstacles) head += "<th>published, %</th>";
  head += "<th>success, %</th><th>lap, s</th><th>timeouts</th>";
  if (compared) head += "<th class=\"words\">verdict</th>";
  return std::string("<h3>") + (obstacles ? "Among obstacles (OA)" : "Path tracking (PT)") +
         "</h3><div class=\"scroll\"><table><thead><tr>" + head + "</tr></thead><tbody>\n" + rows +
         "</tbody></table></div>\n";
}

std::string image(const ReportFigure& figure) {
  return "<img alt=\"" + escaped(figure.title) + "\" src=\"data:" + figure.mime + ";base64," +
         view::base64(figure.data) + "\"><p class=\"caption\">" + escaped(figure.caption) + "</p>\n";
}

std::string tile(const std::string& value, const std::string& words) {
  return "<div class=\"tile\"><b>" + value + "</b><span>" + escaped(words) + "</span></div>\n";
}

std::string tiles(const Report& report) {
  std::string out = "<div class=\"tiles\">\n";
  std::map<std::string, int> kinds;
  for (const Reference& r : report.references)
    if (r.published) ++kinds[verdict_parts(r.verdict).first];
  if (!kinds.empty())
    out +=
        tile(std::to_string(kinds[verdicts::log]) + " \xC2\xB7 " + std::to_string(kinds[verdicts::released]) +
                 " \xC2\xB7 " + std::to_string(kinds[verdicts::neither] + kinds[verdicts::not_log]),
             "experiments that agree with the published log, with the paper's program but not the log, and "
             "with neither");
  for (const char* scenario : {"pt", "oa"}) {
    const auto row = std::find_if(report.rows.begin(), report.rows.end(), [&](const ReportRow& r) {
      return report.experiment(r).scenario == scenario && report.experiment(r).method == "svg_mppi" &&
             report.experiment(r).set.empty();
    });
    if (row == report.rows.end()) continue;
    const auto& r = report.result(*row);
    const Reference* reference = report.reference(*row);
    const bool tracking = scenario == std::string("pt");
    out += tile(number(r.ms_mean),
                std::string("MS of SVG-MPPI, ") + (tracking ? "path tracking" : "obstacles") +
                    (reference ? "; published " + number(reference->published->ms_mean) : ""));
    if (r.collision_rate)
      out +=
          tile(number(100 * *r.collision_rate, 1) + " %",
               "collision rate of SVG-MPPI" +
                   (reference ? "; published " + number(100 * *reference->published->collision_rate, 1) + " %"
                              : std::string()));
  }
  return out + "</div>\n";
}

/// Every experiment against one, on the same seeds.
std::string paired_table(const Report& report) {
  const auto& experiments = report.evaluated.evaluation.experiments;
  const auto is_ours = [&](int i) {
    const auto& e = experiments[static_cast<std::size_t>(i)];
    return e.method == "svg_mppi" && e.set.empty();
  };
  const auto name_of = [&](int i) {
    const auto row = std::find_if(report.rows.begin(), report.rows.end(),
                                  [&](const ReportRow& r) { return r.experiment == i; });
    return row == report.rows.end() ? experiments[static_cast<std::size_t>(i)].label() : row->name;
  };
  std::string rows;
  for (const PairedComparison& c : compare_pairs(report.evaluated.rows, experiments)) {
    if (is_ours(c.a) == is_ours(c.b)) continue;
    const bool turned = is_ours(c.b);
    const int index = turned ? c.a : c.b;
    const auto& other = experiments[static_cast<std::size_t>(index)];
    rows += "<tr><td>" + escaped(name_of(index)) + "</td><td>" + other.scenario + "</td><td>" +
            std::to_string(c.laps) + "</td><td>" + number(turned ? c.ms_difference : -c.ms_difference) +
            "</td><td>" + p_value(c.ms_p) + "</td><td>" +
            std::to_string(turned ? c.only_b_succeeds : c.only_a_succeeds) + "</td><td>" +
            std::to_string(turned ? c.only_a_succeeds : c.only_b_succeeds) + "</td><td>" +
            p_value(c.success_p) + "</td></tr>\n";
  }
  if (rows.empty()) return {};
  return "<section><h2>Paired comparison with SVG-MPPI</h2><p class=\"caption\">Both drive the same seeds "
         "and therefore the same "
         "obstacles. MS by Wilcoxon's signed-rank test, success (finished without collision) by "
         "McNemar's.</p>"
         "<div class=\"scroll\"><table><thead><tr><th></th><th></th><th>laps</th><th>MS above "
         "SVG-MPPI</th><th>p</th>"
         "<th>only SVG-MPPI succeeds</th><th>only this method succeeds</th><th>p</th></tr></thead><tbody>\n" +
         rows + "</tbody></table></div></section>\n";
}

std::string page(const Report& report, const std::vector<ReportFigure>& figures) {
  const auto settings = Json::parse(report.evaluated.evaluation.settings);
  const auto word = [&](const char* key) { return escaped(settings[key].get<std::string>()); };
  std::string html =
      "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>" +
      escaped(report.title) + "</title><style>" + style + "</style><main>\n<h1>" + escaped(report.title) +
      "</h1><p class=\"sub\">" + std::to_string(report.evaluated.rows.size()) + " laps on " + word("course") +
      " \xC2\xB7 configuration " + word("config") + " \xC2\xB7 evaluation " + word("evaluation") +
      " \xC2\xB7 slalom " + version() + "</p>\n";
  for (const std::string& note : report.notes) html += "<p class=\"note\">" + escaped(note) + "</p>\n";
  html += tiles(report);
  std::vector<std::string> sections;
  for (const ReportRow& row : report.rows)
    if (std::find(sections.begin(), sections.end(), row.section) == sections.end())
      sections.push_back(row.section);
  for (const std::string& section : sections) {
    html += std::string("<section><h2>") + heading(section) + "</h2>\n";
    for (const ReportFigure& figure : figures)
      if (figure.section == section) html += image(figure);
    html += table(report, section, "pt") + table(report, section, "oa") + "</section>\n";
  }
  html += paired_table(report);
  for (const ReportFigure& figure : figures)
    if (figure.section.empty())
      html += "<section><h2>" + escaped(figure.title) + "</h2>\n" + image(figure) + "</section>\n";
  html +=
      "<section><h2>How to read this</h2><p>MS, the mean sequence cost, is the state and collision cost of "
      "the "
      "trajectory predicted for the control sequence sent, averaged over a lap's control steps; intervals "
      "are "
      "bootstraps over laps. The collision rate is the number of collisions divided by the number of "
      "obstacles, with Wilson's interval. "
      "\xE2\x80\x9COutside\xE2\x80\x9D: at 5 % a two-sample bootstrap of MS (with fewer than 10 laps a "
      "permutation test) or Fisher's exact test of collisions distinguishes these laps from the published "
      "ones. "
      "\xE2\x80\x9CInside\xE2\x80\x9D: neither does, and the intervals of the differences are narrower "
      "than half of the published MS and 10 points of the collision rate to either side. "
      "\xE2\x80\x9CUndecided\xE2\x80\x9D: neither does, but the laps are too few or too scattered to "
      "decide. Laps that time out count like all others.</p><details><summary>All settings</summary><pre>" +
      escaped(settings.dump(1)) + "</pre></details></section>\n</main></html>\n";
  return html;
}

}  // namespace

void write_report(const Report& report, const fs::path& folder) {
  const fs::path pictures = folder / "figures";
  std::error_code error;
  fs::create_directories(pictures, error);
  if (error) throw IoError(pictures.string(), 0, "cannot be created: " + error.message());
  auto figures = report_charts(report, pictures);
  for (ReportFigure& figure : report_pictures(report, pictures)) figures.push_back(std::move(figure));
  const fs::path file = folder / "report.html";
  std::ofstream stream(file, std::ios::binary);
  stream << page(report, figures);
  if (!stream.flush()) throw IoError(file.string(), 0, "cannot be written");
}

}  // namespace slalom::tools
