#include "slalom/evaluation/campaign.hpp"

#include <chrono>
#include <exception>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

namespace slalom::evaluation {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

struct Task {
  int experiment;
  int lap;
};

std::vector<Task> open_tasks(const Campaign& campaign, const LapStore& store) {
  std::set<std::pair<int, int>> done;
  for (const LapRow& row : store.rows()) done.insert({row.experiment, row.lap});
  std::vector<Task> tasks;
  for (int e = 0; e < static_cast<int>(campaign.experiments.size()); ++e) {
    for (int lap = 0; lap < campaign.experiments[static_cast<std::size_t>(e)].laps; ++lap) {
      if (!done.contains({e, lap})) tasks.push_back({e, lap});
    }
  }
  return tasks;
}

/// Takes tasks in order and keeps their rows; one for all workers.
class Work {
 public:
  Work(const Campaign& campaign, LapStore& store,
       const std::function<void(const CampaignProgress&)>& on_progress, const std::atomic<bool>& cancel)
      : campaign_(campaign),
        store_(store),
        on_progress_(on_progress),
        cancel_(cancel),
        tasks_(open_tasks(campaign, store)) {
    progress_.laps_resumed = progress_.laps_done = static_cast<int>(store.rows().size());
    progress_.laps_total = progress_.laps_done + static_cast<int>(tasks_.size());
  }

  bool finished() const { return progress_.laps_done == progress_.laps_total; }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

  void run_tasks() noexcept {
    try {
      std::optional<LapRunner> runner;
      int runs = -1;
      while (const auto task = next()) {
        const Experiment& experiment = campaign_.experiments[static_cast<std::size_t>(task->experiment)];
        if (task->experiment != runs) runner.emplace(make_runner(campaign_, task->experiment));
        runs = task->experiment;
        const auto begin = Clock::now();
        const LapResult result =
            runner->run(lap_seed(campaign_.seed0, task->lap, experiment.obstacles), {}, &cancel_);
        if (result.cancelled) return;
        keep(make_row(task->experiment, task->lap, result, seconds_since(begin)));
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
    }
  }

 private:
  std::optional<Task> next() {
    const std::lock_guard lock(mutex_);
    if (error_ || cancel_.load() || next_ == tasks_.size()) return std::nullopt;
    return tasks_[next_++];
  }

  void keep(const LapRow& row) {
    const std::lock_guard lock(mutex_);
    store_.add(row);
    ++progress_.laps_done;
    const int driven = progress_.laps_done - progress_.laps_resumed;
    progress_.seconds_left = seconds_since(begin_) / driven * (progress_.laps_total - progress_.laps_done);
    progress_.last = &row;
    if (on_progress_) on_progress_(progress_);
  }

  const Campaign& campaign_;
  LapStore& store_;
  const std::function<void(const CampaignProgress&)>& on_progress_;
  const std::atomic<bool>& cancel_;
  std::vector<Task> tasks_;
  Clock::time_point begin_ = Clock::now();
  std::mutex mutex_;
  std::size_t next_ = 0;
  CampaignProgress progress_;
  std::exception_ptr error_;
};

}  // namespace

LapRunner make_runner(const Campaign& campaign, int index) {
  const Experiment& experiment = campaign.experiments.at(static_cast<std::size_t>(index));
  vehicle::Configuration configuration = campaign.configuration;
  for (const auto& [key, value] : experiment.set)
    vehicle::set_option(configuration, key, value, experiment.method);
  LapSettings settings;
  settings.obstacles = experiment.obstacles;
  settings.latency = campaign.latency;
  settings.further_costs = campaign.further_costs;
  return LapRunner(campaign.arena, configuration, experiment.method, settings);
}

bool run_campaign(const Campaign& campaign, LapStore& store, int jobs,
                  const std::function<void(const CampaignProgress&)>& on_progress,
                  const std::atomic<bool>& cancel) {
  // Unknown methods and options are found before the first lap.
  for (int i = 0; i < static_cast<int>(campaign.experiments.size()); ++i) make_runner(campaign, i);
  Work work(campaign, store, on_progress, cancel);
  std::vector<std::thread> workers;
  for (int i = 1; i < jobs; ++i) workers.emplace_back([&work] { work.run_tasks(); });
  work.run_tasks();
  for (auto& worker : workers) worker.join();
  work.rethrow();
  if (!work.finished()) return false;
  store.complete();
  return true;
}

}  // namespace slalom::evaluation
