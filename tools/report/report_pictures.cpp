#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <map>

#include "slalom/sim/shapes.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "tools/drawing/lap_picture.hpp"
#include "tools/drawing/map_picture.hpp"
#include "tools/report/report.hpp"

namespace slalom::tools {
namespace {

using namespace evaluation;

constexpr Colour path_colour{0.62, 0.66, 0.73, 0.9}, obstacle_fill{0.32, 0.36, 0.44, 1};
constexpr int long_side = 1300;

ReportFigure save(const MapPicture& picture, ReportFigure figure, const std::filesystem::path& folder) {
  const auto file = folder / (figure.name + ".png");
  picture.save(file);
  std::ifstream stream(file, std::ios::binary);
  figure.mime = "image/png";
  figure.data.assign(std::istreambuf_iterator<char>(stream), {});
  return figure;
}

struct Line {
  DrivenLine driven;
  LapResult lap;
};

Line drive_again(const Evaluation& evaluation, int experiment, int lap) {
  Line line;
  const int obstacles = evaluation.experiments[static_cast<std::size_t>(experiment)].obstacles;
  line.lap = run_lap(lap_setup(evaluation, experiment), lap_seed(evaluation.seed0, lap, obstacles),
                     [&](const ControlStep& tick) {
                       line.driven.points.push_back({tick.seen.pose.x, tick.seen.pose.y});
                     });
  return line;
}

/// SVG-MPPI as it is and plain MPPI, if both drove; else the first two.
std::vector<int> pair_of(const Report& report, const std::string& scenario) {
  std::vector<int> all, chosen;
  for (const ReportRow& row : report.rows) {
    if (report.experiment(row).scenario == scenario &&
        std::find(all.begin(), all.end(), row.experiment) == all.end())
      all.push_back(row.experiment);
  }
  const auto& experiments = report.evaluated.evaluation.experiments;
  const auto take = [&](auto&& fits) {
    const auto found = std::find_if(all.begin(), all.end(), [&](int i) {
      return chosen.size() < 2 && std::find(chosen.begin(), chosen.end(), i) == chosen.end() &&
             fits(experiments[static_cast<std::size_t>(i)]);
    });
    if (found != all.end()) chosen.push_back(*found);
  };
  take([](const Experiment& e) { return e.method == "svg_mppi" && e.set.empty(); });
  // The paper draws plain MPPI with this variance.
  const auto before = chosen.size();
  take([](const Experiment& e) { return e.method == "mppi" && e.set_text() == "mppi.variance=0.075"; });
  if (chosen.size() == before) take([](const Experiment& e) { return e.method == "mppi"; });
  take([](const Experiment&) { return true; });
  take([](const Experiment&) { return true; });
  return chosen;
}

/// The first lap (from 0) in which only the second method collides; otherwise the first.
int telling_lap(const Report& report, const std::vector<int>& pair) {
  std::map<int, std::array<int, 2>> contacts;
  for (const LapRow& row : report.evaluated.rows)
    for (std::size_t side = 0; side < pair.size(); ++side)
      if (row.experiment == pair[side]) contacts[row.lap][side] = row.collisions;
  for (const auto& [lap, count] : contacts)
    if (count[0] == 0 && count[1] > 0) return lap;
  return 0;
}

std::vector<maps::Point> points_of(const std::vector<maps::ReferencePoint>& path) {
  std::vector<maps::Point> points;
  for (const auto& point : path) points.push_back({point.x, point.y});
  return points;
}

ReportFigure driven_lines(const Report& report, const maps::OccupancyGrid& map, const std::string& scenario,
                          const std::vector<int>& pair, const std::filesystem::path& folder) {
  const Evaluation& evaluation = report.evaluated.evaluation;
  const int lap = scenario == "pt" ? 0 : telling_lap(report, pair);
  std::vector<Line> lines;
  for (const int experiment : pair) lines.push_back(drive_again(evaluation, experiment, lap));
  const auto path = points_of(evaluation.environment->path);
  auto shown = path;
  for (const Line& line : lines)
    shown.insert(shown.end(), line.driven.points.begin(), line.driven.points.end());
  MapPicture picture(cropped(map, shown, 1.5), long_side);
  picture.line(path, path_colour, 2, evaluation.environment->course.closed, true);
  const sim::CarParameters car;
  for (const maps::Pose& obstacle : lines.front().lap.obstacles) {
    const auto corners = sim::corners({obstacle, car.length, car.width});
    picture.polygon({corners.begin(), corners.end()}, obstacle_fill, white);
  }
  std::vector<std::pair<std::string, Colour>> key;
  std::string facts = "lap " + std::to_string(lap + 1);
  const auto& experiments = evaluation.experiments;
  const auto colour_of = [&](std::size_t i) {
    const bool same = pair.size() > 1 && experiments[static_cast<std::size_t>(pair[0])].method ==
                                             experiments[static_cast<std::size_t>(pair[1])].method;
    const Colour own = method_colour(experiments[static_cast<std::size_t>(pair[i])].method);
    return same && i > 0 ? mixed(own, white, 0.45) : own;
  };
  for (std::size_t i = lines.size(); i-- > 0;) {
    const Colour colour = colour_of(i);
    picture.line(lines[i].driven.points, colour, 4.5, false);
    for (const Collision& collision : lines[i].lap.first_collisions)
      picture.disc({collision.pose.x, collision.pose.y}, 11, colour);
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto row = std::find_if(report.rows.begin(), report.rows.end(),
                                  [&](const ReportRow& r) { return r.experiment == pair[i]; });
    key.emplace_back(row->name, colour_of(i));
    char words[80];
    std::snprintf(words, sizeof words, " \xC2\xB7 MS %.2f, %d collision%s", lines[i].lap.mean_sequence_cost,
                  lines[i].lap.collisions, lines[i].lap.collisions == 1 ? "" : "s");
    facts += words;
  }
  const bool tracking = scenario == "pt";
  picture.key(tracking ? "Path tracking" : "Among obstacles", facts, key);
  std::string caption = tracking ? "The first lap of both, on the reference path (dashed). "
                                 : "The same obstacles for both; discs mark collisions. ";
  if (!tracking)
    caption +=
        "The lap is the first in which only the second method collides, if there is one: it "
        "shows how collisions happen, not how often.";
  return save(picture,
              {"driven_" + scenario, "", tracking ? "Driven lines: path tracking" : "Driven lines: obstacles",
               caption},
              folder);
}

}  // namespace

std::vector<ReportFigure> report_pictures(const Report& report, const std::filesystem::path& folder) {
  // The world of the published evaluation takes unknown ground for free; a picture should not.
  const auto map = vehicle::load_course(report.evaluated.course_folder).map;
  std::vector<ReportFigure> figures;
  for (const char* scenario : {"pt", "oa"}) {
    const auto pair = pair_of(report, scenario);
    if (!pair.empty()) figures.push_back(driven_lines(report, map, scenario, pair, folder));
  }
  return figures;
}

}  // namespace slalom::tools
