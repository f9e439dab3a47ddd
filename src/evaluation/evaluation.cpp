#include "slalom/evaluation/evaluation.hpp"

#include <chrono>
#include <cstdio>
#include <mutex>
#include <set>

#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "slalom/evaluation/worker_threads.hpp"

namespace slalom::evaluation {
namespace {

namespace fs = std::filesystem;
constexpr const char* journal_name = "laps.journal.csv";
constexpr const char* checksum_key = "checksum";

/// The 64-bit FNV-1a hash of the settings, written with their keys in order.
std::string checksum_of(const Json& settings) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : json_text(settings)) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  char digits[20];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(hash));
  return digits;
}

/// "key: 1 stored, 2 requested; ..." for every value that differs.
std::string differences(const Json& stored, const Json& requested) {
  const Json a = stored.flatten(), b = requested.flatten();
  std::set<std::string> paths;
  for (const Json* flat : {&a, &b})
    for (const auto& each : flat->items()) paths.insert(each.key());
  const auto text_of = [](const Json& flat, const std::string& path) {
    return flat.contains(path) ? json_text(flat.at(path)) : "nothing";
  };
  std::string text;
  for (const std::string& path : paths) {
    const std::string x = text_of(a, path), y = text_of(b, path);
    if (x != y)
      text += (text.empty() ? "" : "; ") + path.substr(1) + ": " + x + " stored, " + y + " requested";
  }
  return text;
}

/// The builds that drove the laps of a folder. Throws IoError if the stored settings are damaged or others
/// than those requested.
std::string stored_builds(const fs::path& file, const std::string& requested) {
  Json stored;
  try {
    const std::string text = read_file(file, max_json_bytes);
    verify_checksum(text);
    stored = parse_json(text);
  } catch (const std::invalid_argument& error) {
    throw IoError(file.string(), 0, error.what());
  }
  const std::string builds = stored.value("build", "unknown");
  stored.erase("build");
  stored.erase(checksum_key);
  const std::string differing = differences(stored, parse_json(requested));
  if (!differing.empty())
    throw IoError(file.string(), 0, "the folder contains an evaluation with other settings: " + differing);
  return builds;
}

std::string with_build(const std::string& settings, const std::string& build) {
  Json json = parse_json(settings);
  if (!build.empty()) json["build"] = build;
  return with_checksum(json_text(json));
}

/// The rows as a table with checksums.
std::string table_text(const std::vector<LapRow>& rows, const std::vector<Experiment>& experiments) {
  std::string text = checked_header(experiments) + "\n";
  for (const LapRow& row : rows) text += checked_line(csv_line(row, experiments)) + "\n";
  return text;
}

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

struct LapTask {
  int experiment, lap;
};

std::vector<LapTask> open_tasks(const Evaluation& evaluation, const LapStore& store) {
  std::set<std::pair<int, int>> done;
  for (const LapRow& row : store.rows()) done.insert({row.experiment, row.lap});
  std::vector<LapTask> tasks;
  for (int e = 0; e < static_cast<int>(evaluation.experiments.size()); ++e)
    for (int lap = 0; lap < evaluation.experiments[static_cast<std::size_t>(e)].laps; ++lap)
      if (!done.contains({e, lap})) tasks.push_back({e, lap});
  return tasks;
}

}  // namespace

std::string with_checksum(const std::string& settings) {
  Json json = parse_json(settings);
  json.erase(checksum_key);
  json[checksum_key] = checksum_of(json);
  return json_text(json, 2);
}

void verify_checksum(const std::string& stored_settings) {
  Json json = parse_json(stored_settings);
  if (!json.is_object()) throw std::invalid_argument("is not a JSON object");
  const Json stored = json.value(checksum_key, Json());
  json.erase(checksum_key);
  if (stored != Json(checksum_of(json)))
    throw std::invalid_argument(
        "key checksum: is not that of the settings: the file is damaged or was edited");
}

LapStore::LapStore(const fs::path& folder, const Evaluation& evaluation, bool resume)
    : folder_(folder), lock_(folder), experiments_(evaluation.experiments) {
  const fs::path settings = folder / "settings.json", journal = folder / journal_name,
                 table = folder / "laps.csv";
  const bool complete = fs::exists(table);
  std::string builds = evaluation.build;
  if (complete || fs::exists(journal)) {
    if (!resume)
      throw IoError(folder.string(), 0,
                    "contains the laps of an evaluation: give --resume to continue it, or another folder");
    builds = stored_builds(settings, evaluation.settings);
    if (!builds.ends_with(evaluation.build)) {
      if (!complete && !evaluation.any_build)
        throw IoError(settings.string(), 0,
                      "the laps were driven by another build of the program (build " + builds + ", this is " +
                          evaluation.build +
                          "), whose laps may differ. Continue with that build, choose another folder, or "
                          "give --any-build to mix them");
      builds += " " + evaluation.build;
    }
    rows_ = read_rows(complete ? table : journal, experiments_, !complete, evaluation.seed0);
  }
  if (complete) {
    std::size_t laps = 0;
    for (const Experiment& each : experiments_) laps += static_cast<std::size_t>(each.laps);
    sort();
    if (rows_.size() < laps)
      throw IoError(table.string(), 0,
                    std::to_string(laps - rows_.size()) + " laps are missing; rename the file to " +
                        journal_name + " to continue the evaluation");
    return;
  }
  replace_file(settings, with_build(evaluation.settings, builds));
  replace_file(journal, table_text(rows_, experiments_));  // without a truncated line
  journal_.open(journal, std::ios::binary | std::ios::app);
  if (!journal_) throw_system_error(journal, "cannot be written");
}

void LapStore::sort() {
  std::sort(rows_.begin(), rows_.end(), [](const LapRow& a, const LapRow& b) {
    return std::pair(a.experiment, a.lap) < std::pair(b.experiment, b.lap);
  });
}

void LapStore::add(const LapRow& row) {
  journal_ << checked_line(csv_line(row, experiments_)) + "\n" << std::flush;
  if (!journal_) throw_system_error(folder_ / journal_name, "cannot be written");
  rows_.push_back(row);
}

void LapStore::complete() {
  if (!journal_.is_open()) return;
  sort();
  replace_file(folder_ / "laps.csv", table_text(rows_, experiments_));
  journal_.close();
  fs::remove(folder_ / journal_name);
}

std::optional<LapRow> drive_row(const Evaluation& evaluation, const LapSetup& setup, int experiment, int lap,
                                const std::atomic<bool>& cancel) {
  const auto begin = Clock::now();
  const std::uint64_t seed = lap_seed(evaluation.seed0, lap, setup.settings.obstacles);
  const LapResult result = run_lap(setup, seed, {}, &cancel);
  if (result.cancelled) return std::nullopt;
  return make_row(experiment, lap, result, seconds_since(begin));
}

bool drive_laps(const Evaluation& evaluation, LapStore& store, int jobs,
                const std::function<void(const EvaluationProgress&)>& on_progress,
                const std::atomic<bool>& cancel) {
  const std::vector<LapTask> tasks = open_tasks(evaluation, store);
  std::vector<LapSetup> setups;
  for (int e = 0; e < static_cast<int>(evaluation.experiments.size()); ++e)
    setups.push_back(lap_setup(evaluation, e));
  EvaluationProgress progress;
  progress.laps_resumed = progress.laps_done = static_cast<int>(store.rows().size());
  progress.laps_total = progress.laps_done + static_cast<int>(tasks.size());
  const auto begin = Clock::now();
  std::mutex mutex;
  const auto drive = [&](int task) {
    const auto [experiment, lap] = tasks[static_cast<std::size_t>(task)];
    const LapSetup& setup = setups[static_cast<std::size_t>(experiment)];
    const std::optional<LapRow> row = drive_row(evaluation, setup, experiment, lap, cancel);
    if (!row) return;
    const std::lock_guard lock(mutex);
    store.add(*row);
    ++progress.laps_done;
    const int driven = progress.laps_done - progress.laps_resumed;
    progress.seconds_left = seconds_since(begin) / driven * (progress.laps_total - progress.laps_done);
    on_progress(progress);
  };
  for_each_in_threads(jobs, static_cast<int>(tasks.size()), drive, &cancel);
  if (progress.laps_done != progress.laps_total) return false;
  store.complete();
  return true;
}

LapSetup lap_setup(const Evaluation& evaluation, int index) {
  const Experiment& experiment = evaluation.experiments.at(static_cast<std::size_t>(index));
  LapSetup setup{evaluation.environment, {evaluation.configuration, experiment.method}};
  LapSettings& settings = setup.settings;
  settings.obstacles = experiment.obstacles;
  settings.latency = evaluation.latency;
  if (evaluation.hardware) settings.hardware.emplace();
  for (const auto& [key, value] : experiment.set)
    if (!set_world_option(settings, key, value))
      vehicle::set_option(setup.driver.configuration, key, value, experiment.method);
  // All experiments meet the same opponents.
  if (settings.planning_opponents > 0)
    settings.opponent_planner = std::make_shared<const Driver>(Driver{evaluation.configuration});
  return setup;
}

}  // namespace slalom::evaluation
