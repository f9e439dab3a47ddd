
#include "slalom/evaluation/lap.hpp"
#include "slalom/sim/shapes.hpp"
#include "tools/drawing/map_picture.hpp"
#include "tools/report/report.hpp"

namespace slalom::tools {
namespace {

using namespace evaluation;

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

void draw_trajectories(const Evaluated& evaluated, const std::filesystem::path& folder) {
  draw(evaluated, "pt", folder / "fig2a.png");
  draw(evaluated, "oa", folder / "fig2b.png");
}

}  // namespace slalom::tools
