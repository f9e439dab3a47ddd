#include "tools/report/report.hpp"

#include <algorithm>

#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "slalom/core/files/write_file.hpp"
#include "slalom/core/version.hpp"
#include "view/recording/encodings.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using namespace evaluation;

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
  const PaperTable* const table = find_table(section);
  return table ? table->title : "Methods";
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
            "</td><td>" + std::to_string(r.laps) + "</td><td>" +
            (r.laps < fewest_laps ? number(r.ms_mean) : with_interval(r.ms_mean, r.ms_ci)) + "</td>";
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
    rows +=
        "<td>" + number(100 * r.success_rate, 1) + "</td><td>" +
        (r.finished < fewest_laps ? number(r.time_mean, 2) : with_interval(r.time_mean, r.time_ci, 1, 2)) +
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
  head += "<th>success, %</th><th>lap time, s (95 %)</th><th>timeouts</th>";
  if (compared) head += "<th class=\"words\">verdict</th>";
  return std::string("<h3>") + (obstacles ? "Among obstacles (OA)" : "Path tracking (PT)") +
         "</h3><div class=\"scroll\"><table><thead><tr>" + head + "</tr></thead><tbody>\n" + rows +
         "</tbody></table></div>\n";
}

/// A figure with its text.
std::string image(const ReportFigure& figure) {
  const std::string& title = figure.title.empty() ? heading(figure.section) : figure.title;
  return "<img alt=\"" + escaped(title + ". " + figure.caption) + "\" src=\"data:image/svg+xml;base64," +
         view::base64(figure.svg) + "\"><p class=\"caption\">" + escaped(figure.caption) + "</p>\n";
}

std::string page(const Report& report, const std::vector<ReportFigure>& figures) {
  const auto settings = parse_json(report.evaluated.evaluation.settings);
  const auto word = [&](const char* key) { return escaped(settings[key].get<std::string>()); };
  std::string html =
      "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>" +
      escaped(report.title) + "</title><style>" + report_style + "</style><main>\n<h1>" +
      escaped(report.title) + "</h1><p class=\"sub\">" + std::to_string(report.evaluated.rows.size()) +
      " laps on " + word("course") + " \xC2\xB7 configuration " + word("config") + " \xC2\xB7 evaluation " +
      word("evaluation") + " \xC2\xB7 slalom " + version() + "</p>\n";
  for (const std::string& note : report.notes) html += "<p class=\"note\">" + escaped(note) + "</p>\n";
  html += paired_table(report);
  for (const std::string& section : report.sections())
    html += std::string("<section><h2>") + heading(section) + "</h2>\n" + table(report, section, "pt") +
            table(report, section, "oa") + "</section>\n";
  for (const ReportFigure& figure : figures)
    html += "<section><h2>" + escaped(figure.title.empty() ? heading(figure.section) : figure.title) +
            "</h2>\n" + image(figure) + "</section>\n";
  return html + glossary_html(report) + "</main></html>\n";
}

}  // namespace

std::vector<std::string> Report::sections() const {
  std::vector<std::string> all;
  for (const ReportRow& row : rows)
    if (std::find(all.begin(), all.end(), row.section) == all.end()) all.push_back(row.section);
  return all;
}

void write_report(const Report& report, const fs::path& folder) {
  const fs::path pictures = folder / "figures";
  std::error_code error;
  fs::create_directories(pictures, error);
  if (error) throw IoError(pictures.string(), 0, "cannot be created: " + error.message());
  const auto figures = report_charts(report, pictures);
  write_file(folder / "report.html", page(report, figures));
}

}  // namespace slalom::tools
