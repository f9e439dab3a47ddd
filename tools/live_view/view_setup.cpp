#include "tools/live_view/view_setup.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <random>
#include <sstream>
#include <stdexcept>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "slalom/solvers/registry.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "src/evaluation/json.hpp"
#include "tools/command_line/words.hpp"
#include "tools/evaluation/stored_evaluation.hpp"

namespace slalom::tools {
namespace {

/// The configurations that are installed.
std::vector<std::string> configuration_names() {
  std::vector<std::string> names;
  for (const auto& root : vehicle::configuration_roots(program_folder()))
    for (const auto& entry : list_folder(root))
      if (entry.extension() == ".yaml") names.push_back(entry.stem().string());
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::string random_token() {
  std::random_device random;
  std::array<char, 33> text{};
  for (std::size_t i = 0; i < 4; ++i) std::snprintf(text.data() + 8 * i, 9, "%08x", random());
  return text.data();
}

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
                    {"time", row.time},
                    {"contacts", row.collisions},
                    {"points", points(row.collision_points)}});
  return Json{{"type", "evaluation"},
              {"folder", folder_name(stored.folder)},
              {"course", course},
              {"experiments", experiments},
              {"laps", laps}}
      .dump();
}

}  // namespace

view::Choices choices() {
  view::Choices choices;
  choices.courses = vehicle::course_names(vehicle::course_roots(program_folder()));
  for (const char* name : solver_names()) choices.methods.emplace_back(name);
  choices.configurations = configuration_names();
  return choices;
}

std::string further_arguments(const ScenarioArguments& a) {
  std::string words;
  if (a.evaluation != "true") words += " --evaluation " + a.evaluation;
  if (!a.start.empty()) words += " --start " + a.start;
  if (a.latency_ms > 0) words += " --latency-ms " + Json(a.latency_ms).dump();
  for (const std::string& place : a.obstacle) words += " --obstacle " + place;
  for (const std::string& each : a.set) words += " --set '" + each + "'";
  return words;
}

view::ServerOptions server_options(const std::string& host, std::uint16_t port, const std::string& token) {
  // Unreserved characters (RFC 3986, section 2.3): browsers encode all others.
  const auto stands_for_itself = [](unsigned char c) {
    return (c < 128 && std::isalnum(c)) || c == '-' || c == '.' || c == '_' || c == '~';
  };
  if (!std::all_of(token.begin(), token.end(), stands_for_itself))
    throw CommandLineError("--token", token, "must have only letters, digits and - . _ ~");
  view::ServerOptions options;
  options.host = host;
  options.port = port;
  options.token = token.empty() && !view::is_loopback(host) ? random_token() : token;
  return options;
}

void print_address(const std::string& address) {
  std::printf("%s\n", address.c_str());
  std::printf("open this address in a browser; Ctrl-C ends\n");
  std::fflush(stdout);
}

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
    return loaded;
  };
  const view::LoadedLap first = options.load_lap(0, 0);
  options.scenario = first.names;
  options.load = [first, load = options.load](const view::ScenarioNames& names) {
    return names == first.names ? first.scenario : load(names);
  };
}

}  // namespace slalom::tools
