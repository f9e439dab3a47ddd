#pragma once

#include <atomic>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "slalom/evaluation/tuning.hpp"
#include "src/evaluation/json.hpp"
#include "tools/evaluation/evaluation_job.hpp"

namespace slalom::tools {

struct TuningArguments {
  EvaluationArguments evaluation;  ///< its course: one, or several separated by commas
  std::string method = "svg_mppi";
  std::string objective = "ms";
  std::vector<std::string> scenarios{"oa"}, set;
  int obstacles = 5;
  int budget = 400;  ///< laps of the search
  int laps = 4;      ///< laps of every candidate to begin with, in every scenario on every course
  int rounds = 2;
  int held_out = 30;  ///< laps of the final figure, in every scenario on every course; 0: none
};

/// Keeps the plan of a search in `file`, the `plan.json` of its folder: a folder belongs to one search.
/// Throws IoError if the file exists and `resume` is false, if it is no JSON, if a value differs from that of
/// `plan`, and if it cannot be written.
void keep_plan(const std::filesystem::path& file, const Json& plan, bool resume);

/// A search, from its arguments to `best.yaml` and `tune.json`. Every step of it is an evaluation of its own
/// in the folder: an interrupted search can be continued, and its laps can be replayed. While it runs, its
/// folder is locked.
class TuningJob {
 public:
  /// Throws IoError, std::invalid_argument.
  explicit TuningJob(TuningArguments arguments);

  /// False if it was interrupted.
  bool run(const std::atomic<bool>& cancel, std::FILE* words);

  const Json& result() const noexcept { return result_; }

 private:
  /// The results of the candidates in a step.
  struct Driven {
    std::vector<std::vector<double>> values;  ///< values of each candidate's laps, in the same order for all
    Json results = Json::array();
  };

  int places() const { return static_cast<int>(courses_.size() * arguments_.scenarios.size()); }
  Json plan() const;
  bool drive(const std::string& step, const std::vector<evaluation::Candidate>& candidates, int first_lap,
             int laps, const std::atomic<bool>& cancel, Driven& driven) const;
  bool search(int round, const std::atomic<bool>& cancel, std::FILE* words);
  bool hold_out(const std::atomic<bool>& cancel, std::FILE* words);
  void write_best() const;

  TuningArguments arguments_;
  evaluation::Objective objective_;
  std::vector<Scenario> courses_;
  std::vector<evaluation::SearchDimension> dimensions_;
  std::vector<evaluation::Rung> rungs_;  ///< rungs of every round
  evaluation::Candidate best_;           ///< at first the configuration as it stands, which sets nothing
  Json result_;
};

}  // namespace slalom::tools
