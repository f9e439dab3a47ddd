#pragma once

#include "slalom/evaluation/evaluation.hpp"
#include "slalom/evaluation/results.hpp"
#include "tools/command_line/command.hpp"
#include "tools/scenario/scenario.hpp"
#include "tools/terminal/text_table.hpp"

/// Shared by `eval` and `reproduce`: an evaluation from its arguments to laps.csv and summary.json.
namespace slalom::tools {

struct EvaluationArguments {
  ScenarioArguments scenario;  ///< `set` holds what applies to all experiments
  std::uint64_t seed0 = 0;
  int jobs = 0;  ///< 0: one per processor core
  std::string out;
  bool resume = false;
  bool any_build = false;
  bool prepare = false;  ///< only make the folder
  std::string json;      ///< a copy of the summary: a file, or - for standard output
};

/// Adds the options of add_world_options, and --seed, --jobs, --resume, --any-build, --json and --out.
void add_evaluation_options(Subcommand& command, EvaluationArguments& arguments);

/// Hash (FNV-1a) of everything in a course that affects a lap.
std::string course_hash(const evaluation::Environment& environment);

/// The experiments of a comparison: every method in every scenario ("pt", "oa") with every combination of the
/// values of `sweeps` ("key=v1,v2,..."). A sweep over an option of a method's own applies to that method
/// alone, which must be one of them. Throws IoError.
std::vector<evaluation::Experiment> make_experiments(const std::vector<std::string>& methods,
                                                     const std::vector<std::string>& scenarios, int laps,
                                                     int obstacles, const std::vector<std::string>& sweeps);

/// An evaluation that has been driven.
struct Evaluated {
  evaluation::Evaluation evaluation;
  std::vector<evaluation::LapRow> rows;
  std::vector<evaluation::ExperimentResult> results;

  const evaluation::Experiment& experiment(int index) const {
    return evaluation.experiments[static_cast<std::size_t>(index)];
  }
  /// Every pair of experiments of a scenario. MS is not tested where their weights differ.
  std::vector<evaluation::PairedComparison> comparisons() const;
  /// Every other experiment of a scenario (a) compared with its reference (b): svg_mppi with its own options,
  /// else the first.
  std::vector<evaluation::PairedComparison> against_reference() const;
  /// The laps of an experiment in which an obstacle stands where the car starts.
  std::vector<int> laps_begun_in_contact(int experiment) const;
  nlohmann::ordered_json summary() const;
};

/// All that is driven, with the settings that are kept beside the laps.
evaluation::Evaluation make_evaluation(const EvaluationArguments& arguments, const Scenario& scenario,
                                       const std::vector<evaluation::Experiment>& experiments);

/// Drives what is still missing in `arguments.out`, with a progress line. False, without results, if it was
/// interrupted or is only prepared. Throws CommandLineError, IoError and the errors of a lap.
bool run_evaluation(const EvaluationArguments& arguments,
                    const std::vector<evaluation::Experiment>& experiments, Evaluated& evaluated);

/// A row an experiment.
TextTable results_table(const Evaluated& evaluated);
/// A row a pair of `against_reference`.
TextTable pairs_table(const Evaluated& evaluated);
/// Prints both tables, and what has none.
void print_results(const Evaluated& evaluated, std::FILE* out);

}  // namespace slalom::tools
