#pragma once

#include "slalom/evaluation/evaluation.hpp"
#include "tools/scenario/scenario.hpp"

/// An evaluation read back from its folder.
namespace slalom::tools {

struct StoredEvaluation {
  std::filesystem::path folder;
  std::string settings;  ///< as settings.json has them
  std::vector<evaluation::Experiment> experiments;
  std::vector<evaluation::LapRow> rows;  ///< rows of the run, so far if it is not done
  bool complete = false;

  /// The experiment so named: by its label (method and options) or, where only one has it, by its method; an
  /// empty scenario fits any. Throws IoError naming those there are.
  int find(const std::string& name, const std::string& scenario) const;
};

/// Throws IoError if the folder does not contain a valid evaluation.
StoredEvaluation load_evaluation(const std::filesystem::path& folder);

/// The same without rows, from the text of settings.json; errors name `folder`.
StoredEvaluation parse_evaluation(const std::string& settings, const std::filesystem::path& folder);

/// The arguments it was driven with. `course` takes the place of the course's name where that is not empty.
ScenarioArguments evaluation_arguments(const StoredEvaluation& stored, const std::string& course);

/// Drives the laps `part` ("EXPERIMENT:LAP EXPERIMENT:LAP ...", experiments by their index) of the evaluation
/// whose settings.json is `settings`, and prints rows as laps.csv has them. Throws IoError if another build
/// or instruction set is to drive it, CommandLineError if there is no such part. False if it was interrupted.
bool drive_part(const std::string& settings, const std::string& part);

/// Restores the evaluation so that its laps can be repeated: course, configuration, all options. `course`
/// takes the place of the course's name where that is not empty. Throws IoError if the course is another one.
evaluation::Evaluation rebuild_evaluation(const StoredEvaluation& stored, const std::string& course,
                                          Scenario& scenario);

}  // namespace slalom::tools
