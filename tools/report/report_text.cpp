#include <algorithm>
#include <cmath>
#include <optional>

#include "json/json.hpp"
#include "tools/command_line/words.hpp"
#include "tools/report/report.hpp"

namespace slalom::tools {

const char* const report_style = R"(
:root{color-scheme:light dark;--ink:#212938;--faint:#5a6478;--rule:#e3e7ee;--blue:#1f5fb5;--good:#1d7f4f;--bad:#a84a16;--paper:#fff;
--ground:#f3f5f9;--note:#fdf7e8;--code:#f6f8fb}
@media(prefers-color-scheme:dark){:root{--ink:#e6eaf1;--faint:#a3adbd;--rule:#303846;--blue:#84b6f5;--good:#1d7f4f;--bad:#a84a16;
--paper:#171c24;--ground:#0e1218;--note:#2d2614;--code:#0e1218}}
*{box-sizing:border-box}
body{margin:0;background:var(--ground);color:var(--ink);font:15px/1.55 system-ui,"Segoe UI",Helvetica,Arial,sans-serif}
main{max-width:1320px;margin:0 auto;padding:36px 28px 80px}
h1{font-size:31px;line-height:1.2;margin:0 0 6px;letter-spacing:-.01em}
h2{font-size:21px;margin:0 0 4px}
h3{font-size:15px;margin:20px 0 6px;color:var(--faint);font-weight:600}
p{margin:6px 0;max-width:92ch}
.sub,.caption{color:var(--faint)}
.caption{font-size:13.5px}
section{background:var(--paper);border:1px solid var(--rule);border-radius:12px;padding:24px 26px;margin-top:22px}
.note{border-left:3px solid #e0a030;background:var(--note);padding:8px 14px;border-radius:0 8px 8px 0;margin-top:14px}
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
img{max-width:100%;max-height:1000px;display:block;margin:14px auto 6px;background:#fff;border-radius:8px;padding:6px}
details{margin-top:10px}summary{cursor:pointer;color:var(--blue)}
pre{overflow-x:auto;background:var(--code);padding:12px;border-radius:8px;font-size:12.5px}
@media(max-width:600px){main{padding:18px 10px 40px}section{padding:14px 12px}h1{font-size:24px}h2{font-size:18px}
td,th{padding:5px 6px}}
@media print{body{background:#fff}section{break-inside:avoid;border:0;padding:8px 0}}
)";

namespace {

using namespace evaluation;

/// A p-value (0 .. 1), a dash where there is none.
std::string p_value(const std::optional<double>& p) {
  return p && *p < 0.001 ? "&lt; 0.001" : number(p.value_or(std::nan("")));
}

std::string name_of(const Report& report, int experiment) {
  const auto row = std::find_if(report.rows.begin(), report.rows.end(),
                                [&](const ReportRow& r) { return r.experiment == experiment; });
  const auto& experiments = report.evaluated.evaluation.experiments;
  return row == report.rows.end() ? experiments[static_cast<std::size_t>(experiment)].label() : row->name;
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '&'   ? "&amp;"
           : c == '<' ? "&lt;"
           : c == '>' ? "&gt;"
           : c == '"' ? "&quot;"
                      : std::string(1, c);
  return out;
}

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return "\xE2\x80\x93";
  return formatted("%.*f", value >= 100 ? 1 : value >= 10 ? std::min(digits, 2) : digits, value);
}

std::string paired_table(const Report& report) {
  std::string rows;
  for (const PairedComparison& c : report.evaluated.against_reference())
    rows += "<tr><td>" + escaped(name_of(report, c.a)) + "</td><td class=\"words\">" +
            escaped(name_of(report, c.b)) + "</td><td>" + report.evaluated.experiment(c.a).scenario +
            "</td><td>" + std::to_string(c.laps) + "</td><td>" + std::to_string(c.only_b_succeeds) +
            "</td><td>" + std::to_string(c.only_a_succeeds) + "</td><td>" + p_value(c.success_p) +
            "</td><td>" + p_value(c.collisions_p) + "</td><td>" + number(c.time_difference) + "</td><td>" +
            p_value(c.time_p) + "</td><td>" + number(c.ms_difference) + "</td><td>" + p_value(c.ms_p) +
            "</td></tr>\n";
  if (rows.empty()) return {};
  return "<section><h2>Paired comparison</h2><p class=\"caption\">MS is the mean cost of the control "
         "sequences sent "
         "in a lap, lower is better; it is not tested where the weights of the two differ. Both drive the "
         "same seeds "
         "and therefore the same obstacles. MS, lap time and collisions by Wilcoxon's signed-rank test, "
         "success "
         "(finished without collision) by McNemar's.</p><div class=\"scroll\"><table><thead><tr><th></th><th "
         "class=\"words\">compared with</th><th></th><th>laps</th><th>only the other succeeds</th><th>only "
         "this one "
         "succeeds</th><th>p</th><th>collisions, p</th><th>lap time above it, s</th><th>p</th><th>MS above "
         "it</th><th>p</th></tr></thead><tbody>\n" +
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
