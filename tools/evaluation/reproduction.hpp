#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "slalom/evaluation/lap_log.hpp"

/// The simulations of Honda et al. (ICRA 2024, section V-B) as experiments, and what the authors
/// logged.
namespace slalom::tools {

/// A row of the section's tables: a method with its options, in both scenarios.
struct PaperRow {
  std::string section = {};  ///< "baseline", "ablation" or "sweep"
  std::string name = {};     ///< as the paper has it
  std::string method = {};
  std::vector<std::pair<std::string, std::string>> set = {};
  std::string log_pt = {}, log_oa = {};  ///< below the folder of the authors' logs
  std::string lockstep = {};  ///< "svg_mppi": svg_mppi_pt.csv, svg_mppi_oa.csv of the lockstep logs
  std::string released = {};  ///< row of paper_program_laps
  std::string note = {};      ///< a remark on the authors' figure

  const std::string& log(const std::string& scenario) const { return scenario == "pt" ? log_pt : log_oa; }
};

/// All rows. The ablations' two files without a nominal sequence are taken for what they hold: in the
/// authors' repository, and in table II of the paper, the two scenarios are swapped.
std::vector<PaperRow> paper_rows();

/// The different experiments of the rows of these sections, section by section.
std::vector<evaluation::Experiment> paper_experiments(const std::vector<std::string>& sections, int laps_pt,
                                                      int laps_oa, int obstacles);

/// Whether an experiment is that of a row.
bool drives(const evaluation::Experiment& experiment, const PaperRow& row);

/// The first words of a verdict; figures and reasons follow after a colon.
namespace verdicts {
inline constexpr const char* log = "agrees with the log";  ///< no significant difference
/// A significant difference from the log, and none from the paper's program in this simulator.
inline constexpr const char* released = "agrees with the paper's program, not with the log";
inline constexpr const char* neither = "disagrees with both";
/// A significant difference from the log; the paper's program has no laps of the row.
inline constexpr const char* not_log = "disagrees with the log";
inline constexpr const char* none = "not compared";
}  // namespace verdicts

/// Reference results of an experiment: logs of the authors, of the paper's program in this simulator, and of
/// a lockstep run.
struct Reference {
  std::optional<evaluation::LapLog> log, released_log, lockstep_log;
  std::optional<evaluation::LogComparison> published, released, lockstep;
  std::string verdict;  ///< one of `verdicts`, and figures
  std::string note;     ///< why, where it is known
};

/// The verdict on `published`, `released` and `lockstep`; `collision_rate` is that of the measured laps.
std::string verdict_of(const Reference& reference, double collision_rate);

/// Folders of logs, and which logs are missing.
struct LogFolders {
  std::filesystem::path published, lockstep;  ///< empty: none
  std::vector<std::string> notes;             ///< for people: what is missing and where to get it
};

/// Looks for the authors' logs in `published` and for a folder `lockstep` beside it. They can be compared
/// only with laps of the course on which they were driven. Throws IoError where `published` is not empty and
/// holds no log.
LogFolders find_logs(const std::string& published, const std::string& course);

/// One per experiment. Throws IoError on a log that is there but cannot be read.
std::vector<Reference> find_references(const LogFolders& folders,
                                       const std::vector<evaluation::Experiment>& experiments,
                                       const std::vector<evaluation::LapRow>& rows);

/// `published`, `paper_program`, `lockstep`, `verdict` and `note` of an entry of a summary's results.
void add_reference(nlohmann::ordered_json& result, const Reference& reference);

}  // namespace slalom::tools
