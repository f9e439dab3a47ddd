#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "slalom/evaluation/lap_table.hpp"

namespace slalom::evaluation {

/// An evaluation: experiments over the same course, configuration and seeds, so that lap k of one experiment
/// is driven among the same obstacles as lap k of another with as many.
struct Evaluation {
  std::shared_ptr<const Environment> environment;
  vehicle::Configuration configuration;
  std::vector<Experiment> experiments;
  std::uint64_t seed0 = 0;
  double latency = 0;            ///< s
  bool additional_costs = true;  ///< also the published model's and the driven cost
  std::string settings;    ///< all that determines the results, as JSON text; two evaluations with other
                           ///< settings do not mix
  std::string build;       ///< names the program that drives: laps of other builds may differ
  bool any_build = false;  ///< mix them all the same
};

/// Drives the laps of one of the evaluation's experiments: run(lap_seed(evaluation.seed0, lap, obstacles)) is
/// its lap `lap`, bit for bit. Throws std::invalid_argument.
LapRunner make_runner(const Evaluation& evaluation, int experiment);

/// How far an evaluation is.
struct EvaluationProgress {
  int laps_done = 0;
  int laps_total = 0;
  int laps_resumed = 0;     ///< of those done, found from an earlier run
  double seconds_left = 0;  ///< estimated
  const LapRow* last = nullptr;
};

/// A lap to be driven.
struct LapTask {
  int experiment = 0;
  int lap = 0;
};

/// Where laps to be driven come from and where driven ones go. Called from several threads at a time.
class LapQueue {
 public:
  virtual ~LapQueue() = default;
  virtual std::optional<LapTask> next() = 0;  ///< none: there is nothing left to do
  virtual void keep(const LapRow& row) = 0;
  virtual void fail(std::exception_ptr error) = 0;  ///< a lap could not be driven
};

/// Drives laps on `jobs` threads until `exchange` has none left or `cancel` is set. The laps do not depend on
/// who drives which.
void drive_laps(const Evaluation& evaluation, LapQueue& exchange, int jobs, const std::atomic<bool>& cancel);

/// Where the laps of an evaluation are kept: `settings.json`, `laps.csv` when complete, and until then a
/// journal to which each lap is appended when it ends. A run may be killed at any moment; with `resume` it
/// goes on, and no finished lap is driven twice.
class LapStore {
 public:
  /// Opens `folder` for the evaluation. Throws IoError if it cannot be written, if it holds results and
  /// `resume` is not said, if it holds an evaluation with other settings (naming what differs), if its laps
  /// are corrupt or not of its seeds, if a laps.csv misses some, and if laps are missing and another build of
  /// the program drove those that are there.
  LapStore(const std::filesystem::path& folder, const Evaluation& evaluation, bool resume);
  ~LapStore();
  LapStore(const LapStore&) = delete;
  LapStore& operator=(const LapStore&) = delete;

  const std::vector<LapRow>& rows() const noexcept { return rows_; }
  /// Keeps a lap: when this returns it survives the process. Throws IoError if it cannot be written.
  void add(const LapRow& row);
  /// All laps are there: writes laps.csv in the order of experiments and laps, and removes the journal.
  void complete();

 private:
  void check_build(const Evaluation& evaluation, const std::string& there) const;

  std::filesystem::path folder_;
  const std::vector<Experiment>& experiments_;
  std::vector<LapRow> rows_;
  int journal_ = -1;
};

/// The laps that a store does not have yet, handed out in order, and what became of them.
class EvaluationQueue final : public LapQueue {
 public:
  EvaluationQueue(const Evaluation& evaluation, LapStore& store,
                  std::function<void(const EvaluationProgress&)> on_progress,
                  const std::atomic<bool>& cancel);

  std::optional<LapTask> next() override;
  void keep(const LapRow& row) override;
  void fail(std::exception_ptr error) override;

  /// When nobody drives any more: completes the store if every lap is there. False if it was cancelled.
  /// Throws what failed.
  bool finish();

 private:
  LapStore& store_;
  std::function<void(const EvaluationProgress&)> on_progress_;
  const std::atomic<bool>& cancel_;
  std::vector<LapTask> tasks_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::mutex mutex_;
  std::size_t next_ = 0;
  EvaluationProgress progress_;
  std::exception_ptr error_;
};

/// Drives every lap that the store does not have yet, on `jobs` threads, and completes the store. The laps do
/// not depend on the number of jobs nor on interruptions. Returns false if `cancel` ended it early. Throws
/// what a lap throws.
bool run_evaluation(const Evaluation& evaluation, LapStore& store, int jobs,
                    const std::function<void(const EvaluationProgress&)>& on_progress,
                    const std::atomic<bool>& cancel);

}  // namespace slalom::evaluation
