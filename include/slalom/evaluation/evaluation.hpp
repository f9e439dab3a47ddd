#pragma once

#include <fstream>

#include "slalom/evaluation/lap_table.hpp"
#include "slalom/evaluation/result_folder.hpp"

namespace slalom::evaluation {

/// Experiments in the same environment, with the same base configuration and the same seeds: lap k of one
/// experiment has the same obstacles as lap k of another with as many.
struct Evaluation {
  std::shared_ptr<const Environment> environment;  ///< where all laps are driven
  vehicle::Configuration
      configuration;  ///< configuration of all experiments, before their own options are set
  std::vector<Experiment> experiments;  ///< the experiments to compare
  std::uint64_t seed0 = 0;              ///< seed of lap 0
  double latency = 0;                   ///< s
  bool hardware = false;                ///< the conditions of a real car, HardwareConditions
  /// All that determines the results, as JSON text. Laps of evaluations with other settings are not mixed.
  std::string settings;
  std::string build;       ///< identifies the program that drives; laps of other builds may differ
  bool any_build = false;  ///< mix laps of different builds
};

/// The laps of one experiment: run_lap with the seed lap_seed(evaluation.seed0, lap, obstacles) is its lap
/// `lap`, bit for bit. Throws std::invalid_argument if an option cannot be set, std::out_of_range if there is
/// no such experiment.
LapSetup lap_setup(const Evaluation& evaluation, int experiment);

/// Drives a lap of the experiment whose setup this is, and measures its wall time; none if `cancel` ended it.
std::optional<LapRow> drive_row(const Evaluation& evaluation, const LapSetup& setup, int experiment, int lap,
                                const std::atomic<bool>& cancel);

/// The progress of an evaluation.
struct EvaluationProgress {
  int laps_done = 0;        ///< laps finished so far
  int laps_total = 0;       ///< laps of all experiments
  int laps_resumed = 0;     ///< number of those done that an earlier run has driven
  double seconds_left = 0;  ///< estimated
};

/// The settings of an evaluation, as JSON text, with their checksum.
std::string with_checksum(const std::string& settings);
/// Throws std::invalid_argument unless stored settings are a JSON object with the checksum of the settings.
void verify_checksum(const std::string& stored_settings);

/// Stores the laps of an evaluation in a folder: `settings.json`, `laps.csv` when all laps are there, and
/// until then a journal to which each lap is appended when it ends. A run may be killed at any time; a later
/// run with `resume` continues it, and no finished lap is driven twice. Settings and rows have checksums. The
/// file `lock` keeps other stores out of the folder.
class LapStore {
 public:
  /// Opens or makes `folder`. The evaluation must outlive the store. Throws IoError
  /// - if the folder cannot be written, or is in use by another store,
  /// - if it contains laps and `resume` is false,
  /// - if it contains an evaluation with other settings (the message names the differences),
  /// - if its laps are corrupt, have other seeds, or are missing in laps.csv,
  /// - if laps are missing, another build has driven those that are there, and `any_build` is false.
  LapStore(const std::filesystem::path& folder, const Evaluation& evaluation, bool resume);

  /// The laps driven so far.
  const std::vector<LapRow>& rows() const noexcept { return rows_; }
  /// Appends a lap to the journal. It survives the end of the process once this returns. Throws IoError if it
  /// cannot be written.
  void add(const LapRow& row);
  /// Writes laps.csv in the order of experiments and laps and removes the journal. To be called when all laps
  /// are there; does nothing if laps.csv was complete. Throws IoError if it cannot be written.
  void complete();

 private:
  void sort();

  std::filesystem::path folder_;
  FolderLock lock_;
  const std::vector<Experiment>& experiments_;
  std::vector<LapRow> rows_;
  std::ofstream journal_;
};

/// Drives the laps that the store does not have yet, in up to `jobs` threads, and completes it. Calls
/// `on_progress` after each lap, one call at a time. Returns whether all laps are there: false if `cancel`
/// ended the evaluation. Throws what the first lap threw that could not be driven or stored. The results do
/// not depend on which thread drives which lap.
bool drive_laps(const Evaluation& evaluation, LapStore& store, int jobs,
                const std::function<void(const EvaluationProgress&)>& on_progress,
                const std::atomic<bool>& cancel);

}  // namespace slalom::evaluation
