#include <algorithm>

#include "tools/drawing/row_chart.hpp"
#include "tools/report/report.hpp"

namespace slalom::tools {
namespace {

using evaluation::LapRow;

ReportFigure saved(const Drawing& drawing, ReportFigure figure, const std::filesystem::path& folder) {
  figure.svg = to_svg(drawing);
  save(drawing, folder / (figure.name + ".svg"));
  save(drawing, folder / (figure.name + ".png"));
  return figure;
}

Marks cost_marks(const Report& report, const ReportRow& row) {
  Marks marks;
  for (const LapRow& lap : report.evaluated.rows)
    if (lap.experiment == row.experiment) marks.values.push_back(lap.mean_sequence_cost());
  return marks;
}

/// Rows of a section, by name: its experiment in each scenario.
struct NamedRow {
  std::string name;
  const ReportRow *pt = nullptr, *oa = nullptr;
};

std::vector<NamedRow> named_rows(const Report& report, const std::string& section) {
  std::vector<NamedRow> rows;
  for (const ReportRow& row : report.rows) {
    if (row.section != section) continue;
    auto found = std::find_if(rows.begin(), rows.end(), [&](const auto& r) { return r.name == row.name; });
    if (found == rows.end()) found = rows.insert(rows.end(), NamedRow{row.name});
    (report.experiment(row).scenario == "pt" ? found->pt : found->oa) = &row;
  }
  return rows;
}

bool has_references(const Report& report) {
  return std::any_of(report.references.begin(), report.references.end(),
                     [](const Reference& r) { return r.published.has_value(); });
}

Panel cost_panel(const Report& report, const std::vector<NamedRow>& rows, const char* title,
                 const ReportRow* NamedRow::*scenario) {
  Panel panel{
      .title = title, .axis = "mean sequence cost (MS) of a lap, lower is better", .ours = {}, .theirs = {}};
  for (const NamedRow& row : rows) {
    Marks ours, theirs;
    if (const ReportRow* at = row.*scenario) {
      ours = cost_marks(report, *at);
      if (const Reference* r = report.reference(*at)) theirs.values = r->log->ms;
    }
    panel.ours.push_back(ours);
    panel.theirs.push_back(theirs);
  }
  if (!has_references(report)) panel.theirs.clear();
  return panel;
}

Panel collision_panel(const Report& report, const std::vector<NamedRow>& rows) {
  Panel panel{.title = "Obstacles: collisions",
              .axis = "collision rate, %, with its 95 % interval",
              .kind = Panel::Kind::bars,
              .ours = {},
              .theirs = {}};
  for (const NamedRow& row : rows) {
    Marks ours, theirs;
    if (row.oa) {
      const auto& r = report.result(*row.oa);
      ours.span =
          Span{100 * *r.collision_rate, 100 * r.collision_rate_ci->low, 100 * r.collision_rate_ci->high};
      if (const Reference* reference = report.reference(*row.oa)) {
        const auto& c = *reference->published;
        theirs.span =
            Span{100 * *c.collision_rate, 100 * c.collision_rate_ci->low, 100 * c.collision_rate_ci->high};
      }
    }
    panel.ours.push_back(ours);
    panel.theirs.push_back(theirs);
  }
  if (!has_references(report)) panel.theirs.clear();
  return panel;
}

const PaperTable* table_of(const std::string& section) {
  const auto* const found = std::find_if(std::begin(paper_tables), std::end(paper_tables),
                                         [&](const PaperTable& table) { return table.name == section; });
  return found == std::end(paper_tables) ? nullptr : found;
}

RowChart section_chart(const Report& report, const std::string& section) {
  const auto rows = named_rows(report, section);
  RowChart chart;
  if (const PaperTable* table = table_of(section)) {
    chart.title = table->title;
    chart.note = "box: quartiles and median; diamond: mean; points: laps beyond 1.5 boxes; bars: 95 %";
  }
  for (const NamedRow& row : rows) chart.names.push_back(row.name);
  const auto any = [&](auto member) {
    return std::any_of(rows.begin(), rows.end(), [&](const NamedRow& r) { return r.*member != nullptr; });
  };
  if (any(&NamedRow::pt))
    chart.panels.push_back(cost_panel(report, rows, "Path tracking: cost", &NamedRow::pt));
  if (any(&NamedRow::oa)) {
    chart.panels.push_back(cost_panel(report, rows, "Obstacles: cost", &NamedRow::oa));
    chart.panels.push_back(collision_panel(report, rows));
  }
  if (has_references(report)) chart.their_key = "published laps";
  return chart;
}

/// Solve times of all laps of a row, from the mean over laps to the maximum.
RowChart time_chart(const Report& report, const std::string& section) {
  RowChart chart;
  Panel panel{.title = "Solve time",
              .axis = "ms: mean to maximum",
              .kind = Panel::Kind::spans,
              .ours = {},
              .theirs = {}};
  for (const NamedRow& row : named_rows(report, section)) {
    const ReportRow& at = row.oa ? *row.oa : *row.pt;
    const auto& r = report.result(at);
    chart.names.push_back(row.name);
    panel.ours.push_back({{}, Span{r.solve_ms_mean, r.solve_ms_mean, r.solve_ms_max}});
    Marks theirs;
    if (const Reference* reference = report.reference(at); reference && reference->log->solve_ms_mean)
      theirs.span = Span{*reference->log->solve_ms_mean, *reference->log->solve_ms_mean,
                         reference->log->solve_ms_max.value_or(*reference->log->solve_ms_mean)};
    panel.theirs.push_back(theirs);
  }
  if (has_references(report)) {
    chart.their_key = "published: 12 threads of a Core i9";
  } else {
    panel.theirs.clear();
  }
  chart.our_key = "Slalom, one thread a lap";
  chart.panels.push_back(panel);
  return chart;
}

}  // namespace

std::vector<ReportFigure> report_charts(const Report& report, const std::filesystem::path& folder) {
  std::vector<std::string> sections;
  for (const ReportRow& row : report.rows)
    if (std::find(sections.begin(), sections.end(), row.section) == sections.end())
      sections.push_back(row.section);
  std::vector<ReportFigure> figures;
  for (const std::string& section : sections) {
    figures.push_back(saved(
        draw_chart(section_chart(report, section)),
        {table_of(section) ? table_of(section)->figure : section, section, "",
         "Every lap counts. Boxes: quartiles and median, whiskers to 1.5 times the box, laps beyond them as "
         "points, the mean as a diamond; the axes of costs are logarithmic. Bars: collision rate with its "
         "95 % Wilson interval."},
        folder));
  }
  if (!sections.empty()) {
    figures.push_back(saved(draw_chart(time_chart(report, sections.front())),
                            {"compute_times", "", "Solve times",
                             "Wall-clock time of a solve, from the mean to the maximum over all laps, "
                             "on a logarithmic axis. It depends on the machine and its load; every other "
                             "figure repeats exactly."},
                            folder));
  }
  return figures;
}

}  // namespace slalom::tools
