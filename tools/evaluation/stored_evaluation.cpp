#include "tools/evaluation/stored_evaluation.hpp"

#include <sstream>

#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "slalom/core/instruction_set.hpp"
#include "slalom/core/read_file.hpp"
#include "tools/evaluation/build_id.hpp"
#include "tools/evaluation/evaluation_job.hpp"
#include "tools/terminal/interrupt.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using evaluation::Experiment;

/// Inverse of Experiment::set_text: "key=value key=value", commas as semicolons.
std::vector<std::pair<std::string, std::string>> parse_set(const std::string& text) {
  std::vector<std::pair<std::string, std::string>> set;
  int depth = 0;
  std::string word;
  const auto take = [&] {
    const auto equals = word.find('=');
    if (equals != std::string::npos) set.emplace_back(word.substr(0, equals), word.substr(equals + 1));
    word.clear();
  };
  for (char c : text) {
    depth += (c == '[') - (c == ']');
    if (c == ';') c = ',';
    if (c == ' ' && depth == 0) {
      take();
    } else {
      word += c;
    }
  }
  take();
  return set;
}

std::string value_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) return json_text(value);
  std::string text = "[";
  for (const auto& each : value) text += (text.size() > 1 ? ", " : "") + value_text(each);
  return text + "]";
}

/// A whole number in [least, most].
int count_of(const Json& experiment, const char* key, int least, int most) {
  const int count = member<int>(experiment, key);
  if (count < least || count > most)
    throw std::invalid_argument(std::string(key) + ": " + std::to_string(count) + " must be in [" +
                                std::to_string(least) + ", " + std::to_string(most) + "]");
  return count;
}

/// The course's folder where it was kept and is still there, else its name.
std::string stored_course(const Json& settings) {
  if (settings.contains("course_folder"))
    if (const auto folder = member<std::string>(settings, "course_folder"); fs::is_directory(folder))
      return folder;
  return member<std::string>(settings, "course");
}

/// Hands the settings of an evaluation to `read`. Throws IoError if they are invalid.
template <class Read>
void with_settings(const StoredEvaluation& stored, const Read& read) {
  try {
    read(parse_json(stored.settings));
  } catch (const std::invalid_argument& error) {
    throw IoError((stored.folder / "settings.json").string(), 0, std::string("is invalid: ") + error.what());
  }
}

}  // namespace

StoredEvaluation parse_evaluation(const std::string& text, const fs::path& folder) {
  StoredEvaluation stored{folder, text, {}, {}, false};
  with_settings(stored, [&](const Json& settings) {
    evaluation::verify_checksum(stored.settings);
    for (const auto& e : member(settings, "experiments")) {
      stored.experiments.push_back({member<std::string>(e, "method"),
                                    parse_set(member<std::string>(e, "set")),
                                    member<std::string>(e, "scenario"), count_of(e, "obstacles", 0, 1000),
                                    count_of(e, "laps", 1, 1000000)});
    }
    if (stored.experiments.empty()) throw std::invalid_argument("experiments: must be at least one");
  });
  return stored;
}

StoredEvaluation load_evaluation(const fs::path& folder) {
  const fs::path file = folder / "settings.json";
  if (!fs::exists(file))
    throw IoError(file.string(), 0, "cannot be read; the folder must be the output folder of slalom eval");
  StoredEvaluation stored = parse_evaluation(read_file(file, max_json_bytes), folder);
  std::uint64_t seed0 = 0;
  with_settings(stored, [&](const Json& settings) { seed0 = member<std::uint64_t>(settings, "seed0"); });
  const fs::path table = folder / "laps.csv", journal = folder / "laps.journal.csv";
  stored.complete = fs::exists(table);
  stored.rows =
      evaluation::read_rows(stored.complete ? table : journal, stored.experiments, !stored.complete, seed0);
  return stored;
}

int StoredEvaluation::find(const std::string& name, const std::string& scenario) const {
  std::vector<int> by_label, by_method;
  std::string names;
  for (int i = 0; i < static_cast<int>(experiments.size()); ++i) {
    const Experiment& e = experiments[static_cast<std::size_t>(i)];
    names += "\n  " + e.label() + ", " + e.scenario;
    if (!scenario.empty() && e.scenario != scenario) continue;
    if (name.empty() || e.method == name) by_method.push_back(i);
    if (e.label() == name) by_label.push_back(i);
  }
  if (by_label.size() == 1) return by_label.front();
  if (by_label.empty() && by_method.size() == 1) return by_method.front();
  throw IoError(folder.string(), 0, "--method and --scenario must name one of these experiments:" + names);
}

ScenarioArguments evaluation_arguments(const StoredEvaluation& stored, const std::string& course) {
  ScenarioArguments arguments;
  with_settings(stored, [&](const Json& settings) {
    arguments.course = course.empty() ? stored_course(settings) : course;
    arguments.config = member<std::string>(settings, "config");
    arguments.evaluation = member<std::string>(settings, "evaluation");
    arguments.latency_ms = member<double>(settings, "latency_ms");
    arguments.hardware = settings.contains("hardware");
    // The file may say something else by now: every option is set as it was.
    for (const auto& [section, options] : member(settings, "options").items())
      for (const auto& [key, value] : options.items())
        arguments.set.push_back(section + "." + key + "=" + value_text(value));
  });
  return arguments;
}

evaluation::Evaluation rebuild_evaluation(const StoredEvaluation& stored, const std::string& course,
                                          Scenario& scenario) {
  evaluation::Evaluation evaluation;
  with_settings(stored, [&](const Json& settings) {
    const ScenarioArguments arguments = evaluation_arguments(stored, course);
    scenario = load_scenario(arguments, stored.experiments.front().method);
    if (const auto hash = member<std::string>(settings, "course_hash");
        hash != course_hash(*scenario.environment))
      throw IoError(scenario.folder.string(), 0, "is not the course of " + stored.folder.string());
    evaluation.environment = scenario.environment;
    evaluation.configuration = scenario.configuration;
    evaluation.experiments = stored.experiments;
    evaluation.seed0 = member<std::uint64_t>(settings, "seed0");
    evaluation.latency = scenario.lap.latency;
    evaluation.hardware = arguments.hardware;
    evaluation.settings = stored.settings;
  });
  return evaluation;
}

bool drive_part(const std::string& settings, const std::string& part) {
  const StoredEvaluation stored = parse_evaluation(settings, "standard input");
  with_settings(stored, [&](const Json& json) {
    const std::pair<std::string, std::string> ours[] = {
        {"build", build_id()}, {"instruction_set", simd::name(simd::active_target())}};
    for (const auto& [key, here] : ours)
      if (const auto wanted = member<std::string>(json, key.c_str()); !wanted.ends_with(here))
        throw IoError("standard input", 0,
                      key + ": is " + wanted + ", but " + here + " here, whose laps may differ");
  });
  Scenario scenario;
  const evaluation::Evaluation evaluation = rebuild_evaluation(stored, "", scenario);
  const InterruptFlag interrupt;
  std::istringstream words(part);
  for (std::string word; words >> word;) {
    std::size_t experiment = 0;
    int lap = -1;
    char colon = 0;
    std::istringstream numbers(word);
    if (!(numbers >> experiment >> colon >> lap) || colon != ':' || experiment >= stored.experiments.size() ||
        lap < 0 || lap >= stored.experiments[experiment].laps)
      throw CommandLineError("--part", word, "must be EXPERIMENT:LAP of the evaluation");
    const int index = static_cast<int>(experiment);
    const auto row = drive_row(evaluation, lap_setup(evaluation, index), index, lap, interrupt.raised());
    if (!row) return false;
    std::printf("%s\n", evaluation::checked_line(csv_line(*row, stored.experiments)).c_str());
  }
  return true;
}

}  // namespace slalom::tools
