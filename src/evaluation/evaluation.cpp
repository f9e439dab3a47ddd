#include "slalom/evaluation/evaluation.hpp"

#include <set>
#include <utility>

#include "slalom/evaluation/worker_threads.hpp"

namespace slalom::evaluation {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

std::vector<LapTask> open_tasks(const Evaluation& evaluation, const LapStore& store) {
  std::set<std::pair<int, int>> done;
  for (const LapRow& row : store.rows()) done.insert({row.experiment, row.lap});
  std::vector<LapTask> tasks;
  for (int e = 0; e < static_cast<int>(evaluation.experiments.size()); ++e) {
    for (int lap = 0; lap < evaluation.experiments[static_cast<std::size_t>(e)].laps; ++lap) {
      if (!done.contains({e, lap})) tasks.push_back({e, lap});
    }
  }
  return tasks;
}

void drive_until_empty(const Evaluation& evaluation, EvaluationQueue& queue,
                       const std::atomic<bool>& cancel) noexcept {
  try {
    LapSetup setup;
    int current = -1;
    while (const auto task = queue.next()) {
      const Experiment& experiment = evaluation.experiments.at(static_cast<std::size_t>(task->experiment));
      if (task->experiment != current) setup = lap_setup(evaluation, task->experiment);
      current = task->experiment;
      const auto begin = Clock::now();
      const LapResult result =
          run_lap(setup, lap_seed(evaluation.seed0, task->lap, experiment.obstacles), {}, &cancel);
      if (result.cancelled) return;
      queue.keep(make_row(task->experiment, task->lap, result, seconds_since(begin)));
    }
  } catch (...) {
    queue.fail(std::current_exception());
  }
}

}  // namespace

int drive_laps(const Evaluation& evaluation, EvaluationQueue& queue, int jobs,
               const std::atomic<bool>& cancel) {
  return run_in_threads(jobs, [&] { drive_until_empty(evaluation, queue, cancel); });
}

EvaluationQueue::EvaluationQueue(const Evaluation& evaluation, LapStore& store,
                                 std::function<void(const EvaluationProgress&)> on_progress,
                                 const std::atomic<bool>& cancel)
    : store_(store),
      on_progress_(std::move(on_progress)),
      cancel_(cancel),
      tasks_(open_tasks(evaluation, store)) {
  progress_.laps_resumed = progress_.laps_done = static_cast<int>(store.rows().size());
  progress_.laps_total = progress_.laps_done + static_cast<int>(tasks_.size());
}

std::optional<LapTask> EvaluationQueue::next() {
  const std::lock_guard lock(mutex_);
  if (error_ || cancel_.load() || next_ == tasks_.size()) return std::nullopt;
  return tasks_[next_++];
}

void EvaluationQueue::keep(const LapRow& row) {
  const std::lock_guard lock(mutex_);
  store_.add(row);
  ++progress_.laps_done;
  const int driven = progress_.laps_done - progress_.laps_resumed;
  progress_.seconds_left = seconds_since(begin_) / driven * (progress_.laps_total - progress_.laps_done);
  progress_.last = &row;
  if (on_progress_) on_progress_(progress_);
}

void EvaluationQueue::fail(std::exception_ptr error) {
  const std::lock_guard lock(mutex_);
  if (!error_) error_ = error;
}

bool EvaluationQueue::finish() {
  const std::lock_guard lock(mutex_);
  if (error_) std::rethrow_exception(error_);
  if (progress_.laps_done != progress_.laps_total) return false;
  store_.complete();
  return true;
}

LapSetup lap_setup(const Evaluation& evaluation, int index) {
  const Experiment& experiment = evaluation.experiments.at(static_cast<std::size_t>(index));
  LapSetup setup{evaluation.environment, {evaluation.configuration, experiment.method}};
  LapSettings& settings = setup.settings;
  settings.obstacles = experiment.obstacles;
  settings.latency = evaluation.latency;
  if (evaluation.hardware) settings.hardware.emplace();
  settings.additional_costs = evaluation.additional_costs;
  for (const auto& [key, value] : experiment.set)
    if (!set_world_option(settings, key, value))
      vehicle::set_option(setup.driver.configuration, key, value, experiment.method);
  // All experiments meet the same opponents.
  if (settings.planning_opponents > 0)
    settings.opponent_planner = std::make_shared<const Driver>(Driver{evaluation.configuration});
  return setup;
}

}  // namespace slalom::evaluation
