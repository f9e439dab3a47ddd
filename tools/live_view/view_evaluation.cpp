#include "tools/live_view/view_evaluation.hpp"

#include <sstream>
#include <stdexcept>

#include "src/evaluation/json.hpp"
#include "tools/evaluation/stored_evaluation.hpp"
#include "tools/live_view/view_setup.hpp"

namespace slalom::tools {
namespace {

/// "x:y x:y" as pairs.
Json points(const std::string& text) {
  Json all = Json::array();
  std::istringstream words(text);
  words.exceptions(std::ios::badbit);  // otherwise the list ends where memory runs out
  for (std::string word; words >> word;) {
    const auto colon = word.find(':');
    if (colon != std::string::npos)
      all.push_back({std::stod(word.substr(0, colon)), std::stod(word.substr(colon + 1))});
  }
  return all;
}

std::string evaluation_message(const StoredEvaluation& stored, const std::string& course) {
  Json experiments = Json::array(), laps = Json::array();
  for (const auto& each : stored.experiments)
    experiments.push_back(
        {{"label", each.label()}, {"scenario", each.scenario}, {"obstacles", each.obstacles}});
  for (const auto& row : stored.rows)
    laps.push_back({{"experiment", row.experiment},
                    {"lap", row.lap},
                    {"seed", std::to_string(row.seed)},
                    {"finished", row.finished},
                    {"time", row.lap_time},
                    {"contacts", row.collisions},
                    {"points", points(row.contact_points)}});
  return Json{{"type", "evaluation"},
              {"folder", stored.folder.filename().empty() ? stored.folder.parent_path().filename().string()
                                                          : stored.folder.filename().string()},
              {"course", course},
              {"experiments", experiments},
              {"laps", laps}}
      .dump();
}

}  // namespace

void open_evaluation(const std::string& folder, view::SessionOptions& options) {
  const auto stored = std::make_shared<const StoredEvaluation>(load_evaluation(folder));
  Scenario scenario;
  const auto evaluation =
      std::make_shared<const evaluation::Evaluation>(rebuild_evaluation(*stored, "", scenario));
  const ScenarioArguments arguments = evaluation_arguments(*stored, "");
  options.evaluation = evaluation_message(*stored, evaluation->environment->course.name);
  options.load_lap = [stored, evaluation, arguments](int experiment, int lap) {
    if (experiment < 0 || experiment >= std::ssize(evaluation->experiments))
      throw std::invalid_argument("experiment: must be one of this evaluation");
    const evaluation::Experiment& e = evaluation->experiments[static_cast<std::size_t>(experiment)];
    if (lap < 0 || lap >= e.laps) throw std::invalid_argument("lap: must be a lap of the experiment");
    const evaluation::LapSetup setup = lap_setup(*evaluation, experiment);
    view::LoadedLap loaded;
    loaded.names = {.course = arguments.course,
                    .method = e.method,
                    .config = arguments.config,
                    .seed = evaluation::lap_seed(evaluation->seed0, lap, e.obstacles),
                    .obstacles = e.obstacles,
                    .opponents = setup.settings.opponents};
    loaded.scenario = {.environment = evaluation->environment,
                       .configuration = setup.driver.configuration,
                       .lap = setup.settings};
    loaded.scenario.lap.additional_costs = false;  // the page does not show them
    return loaded;
  };
  const view::LoadedLap first = options.load_lap(0, 0);
  options.scenario = first.names;
  options.load = [first, load = options.load](const view::ScenarioNames& names) {
    return names == first.names ? first.scenario : load(names);
  };
}

}  // namespace slalom::tools
