#include <algorithm>

#include "slalom/evaluation/lap.hpp"
#include "slalom/sim/shapes.hpp"
#include "tools/drawing/map_picture.hpp"
#include "tools/drawing/row_chart.hpp"
#include "tools/report/report.hpp"

namespace slalom::tools {
namespace {

using namespace evaluation;

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

/// A panel with the marks of `ours` and of `theirs` for the experiment that `choose` picks from each row.
template <class Choose, class Ours, class Theirs>
Panel panel_of(const Report& report, const std::vector<NamedRow>& rows, Panel panel, Choose choose, Ours ours,
               Theirs theirs) {
  for (const NamedRow& row : rows) {
    const ReportRow* const at = choose(row);
    const Reference* const reference = at ? report.reference(*at) : nullptr;
    panel.ours.push_back(at ? ours(*at) : Marks{});
    panel.theirs.push_back(reference ? theirs(*reference) : Marks{});
  }
  if (!has_references(report)) panel.theirs.clear();
  return panel;
}

Panel cost_panel(const Report& report, const std::vector<NamedRow>& rows, const char* title,
                 const ReportRow* NamedRow::*scenario) {
  return panel_of(
      report, rows,
      {.title = title, .axis = "mean sequence cost (MS) of a lap, lower is better", .ours = {}, .theirs = {}},
      [&](const NamedRow& row) { return row.*scenario; },
      [&](const ReportRow& row) { return cost_marks(report, row); },
      [](const Reference& reference) {
        return Marks{reference.log->ms, {}};
      });
}

/// The rate of collisions and its interval, in percent.
Marks rate_marks(const auto& figures) {
  return {{},
          Span{100 * *figures.collision_rate, 100 * figures.collision_rate_ci->low,
               100 * figures.collision_rate_ci->high}};
}

Panel collision_panel(const Report& report, const std::vector<NamedRow>& rows) {
  return panel_of(
      report, rows,
      {.title = "Obstacles: collisions",
       .axis = "collision rate, %, with its 95 % interval",
       .kind = Panel::Kind::bars,
       .ours = {},
       .theirs = {}},
      [](const NamedRow& row) { return row.oa; },
      [&](const ReportRow& row) { return rate_marks(report.result(row)); },
      [](const Reference& reference) { return rate_marks(*reference.published); });
}

RowChart section_chart(const Report& report, const std::string& section) {
  const auto rows = named_rows(report, section);
  RowChart chart;
  if (const PaperTable* table = find_table(section)) {
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
  const auto rows = named_rows(report, section);
  RowChart chart;
  for (const NamedRow& row : rows) chart.names.push_back(row.name);
  chart.our_key = "Slalom, one thread a lap";
  if (has_references(report)) chart.their_key = "published: 12 threads of a Core i9";
  const auto marks = [](double mean, double most) { return Marks{{}, Span{mean, mean, most}}; };
  chart.panels = {panel_of(
      report, rows,
      {.title = "Solve time",
       .axis = "ms: mean to maximum",
       .kind = Panel::Kind::spans,
       .ours = {},
       .theirs = {}},
      [](const NamedRow& row) { return row.oa ? row.oa : row.pt; },
      [&](const ReportRow& row) {
        return marks(report.result(row).solve_mean, report.result(row).solve_max);
      },
      [&](const Reference& reference) {
        const auto& mean = reference.log->solve_ms_mean;
        return mean ? marks(*mean, reference.log->solve_ms_max.value_or(*mean)) : Marks{};
      })};
  return chart;
}

constexpr Colour path_colour{0.62, 0.66, 0.73, 0.9};
constexpr Colour obstacle_fill{0.32, 0.36, 0.44, 1};

/// The experiment of a row of Table II in a scenario, or -1.
int experiment_of(const Evaluated& evaluated, const std::string& row_name, const std::string& scenario) {
  const auto& experiments = evaluated.evaluation.experiments;
  for (const PaperRow& row : paper_rows())
    for (std::size_t i = 0; i < experiments.size(); ++i)
      if (row.table == "table2" && row.name == row_name && experiments[i].scenario == scenario &&
          drives(experiments[i], row))
        return static_cast<int>(i);
  return -1;
}

/// The first lap of an experiment with a collision, or 0.
int lap_to_show(const Evaluated& evaluated, int experiment) {
  for (const LapRow& row : evaluated.rows)
    if (row.experiment == experiment && row.collisions > 0) return row.lap;
  return 0;
}

void draw(const Evaluated& evaluated, const std::string& scenario, const std::filesystem::path& file) {
  const Evaluation& evaluation = evaluated.evaluation;
  const vehicle::Course& course = evaluation.environment->course;
  const int mppi = experiment_of(evaluated, "MPPI", scenario),
            svg = experiment_of(evaluated, "MPPI + NS + AC (SVG-MPPI)", scenario);
  if (mppi < 0 || svg < 0) return;
  const int number = lap_to_show(evaluated, mppi);
  const int obstacles = evaluation.experiments[static_cast<std::size_t>(mppi)].obstacles;
  std::vector<maps::Point> path;
  for (const auto& point : evaluation.environment->path) path.push_back({point.x, point.y});
  MapPicture picture(course.map, 1400, path, 3);
  picture.line(path, path_colour, 2, course.closed, true);
  std::vector<std::pair<std::string, Colour>> key;
  for (const auto& [name, experiment] :
       {std::pair("MPPI, covariance 0.075", mppi), std::pair("SVG-MPPI", svg)}) {
    std::vector<maps::Point> driven;
    const Colour colour = method_colour(evaluation.experiments[static_cast<std::size_t>(experiment)].method);
    const LapResult lap =
        run_lap(lap_setup(evaluation, experiment), lap_seed(evaluation.seed0, number, obstacles),
                [&](const ControlStep& step) {
                  driven.push_back({step.seen.pose.x, step.seen.pose.y});
                });
    if (key.empty())
      for (const maps::Pose& obstacle : lap.obstacles) {
        const sim::CarParameters car;
        const auto corners = sim::corners({obstacle, car.length, car.width});
        picture.polygon({corners.begin(), corners.end()}, obstacle_fill, white);
      }
    picture.line(driven, colour, 5, false);
    for (const Collision& collision : lap.first_collisions)
      picture.disc({collision.pose.x, collision.pose.y}, 9, colour);
    key.emplace_back(name + std::string(", ") + std::to_string(lap.collisions) + " collisions", colour);
  }
  picture.key(scenario == "pt" ? "Fig. 2 (a)" : "Fig. 2 (b)",
              std::string(scenario == "pt" ? "path tracking" : "obstacle avoidance") + ", simulated: lap " +
                  std::to_string(number) + " on " + course.name + "; discs: collisions",
              key);
  picture.save(file);
}

}  // namespace

std::vector<ReportFigure> report_charts(const Report& report, const std::filesystem::path& folder) {
  const std::vector<std::string> sections = report.sections();
  std::vector<ReportFigure> figures;
  for (const std::string& section : sections) {
    figures.push_back(saved(
        draw_chart(section_chart(report, section)),
        {find_table(section) ? find_table(section)->figure : section, section, "",
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

void draw_trajectories(const Evaluated& evaluated, const std::filesystem::path& folder) {
  draw(evaluated, "pt", folder / "fig2a.png");
  draw(evaluated, "oa", folder / "fig2b.png");
}

}  // namespace slalom::tools
