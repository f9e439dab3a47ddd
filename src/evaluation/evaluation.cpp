#include "slalom/evaluation/evaluation.hpp"

#include <chrono>
#include <mutex>
#include <set>
#include <utility>

#include "slalom/evaluation/worker_threads.hpp"

namespace slalom::evaluation {

namespace {

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
    const auto lap_begin = Clock::now();
    const std::uint64_t seed = lap_seed(evaluation.seed0, lap, setup.settings.obstacles);
    const LapResult result = run_lap(setup, seed, {}, &cancel);
    if (result.cancelled) return;
    const LapRow row = make_row(experiment, lap, result, seconds_since(lap_begin));
    const std::lock_guard lock(mutex);
    store.add(row);
    ++progress.laps_done;
    const int driven = progress.laps_done - progress.laps_resumed;
    progress.seconds_left = seconds_since(begin) / driven * (progress.laps_total - progress.laps_done);
    progress.last = &row;
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
