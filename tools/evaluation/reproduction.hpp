#pragma once

#include <nlohmann/json_fwd.hpp>

#include "slalom/evaluation/lap_log.hpp"

/// The simulations of Honda et al. (ICRA 2024, section V-B) as experiments, and what the authors logged.
namespace slalom::tools {

/// A part of the simulation section.
struct PaperTable {
  const char* name;    ///< as in --tables
  const char* figure;  ///< name of its picture
  const char* title;   ///< as the paper numbers it
};
inline constexpr PaperTable paper_tables[] = {
    {"table1", "fig5", "Table I and Fig. 5: the baselines"},
    {"table2", "table2", "Table II: nominal sequence (NS) and adaptive covariance (AC)"},
    {"covariances", "covariances", "Nominal sequence with fixed covariances: in the logs, not in the paper"},
};

/// The table of this name; null if there is none.
const PaperTable* find_table(const std::string& name);

/// A row of a table: a method with its options, in both scenarios.
struct PaperRow {
  std::string table = {};  ///< name of a PaperTable
  std::string name = {};   ///< as the paper has it
  std::string method = {};
  std::vector<std::pair<std::string, std::string>> set = {};
  std::string log_pt = {}, log_oa = {};  ///< files of the authors, below PaperFiles::logs
  std::string released = {};             ///< row of paper_program_laps
  std::string note = {};                 ///< a remark on the authors' figure

  const std::string& log(const std::string& scenario) const { return scenario == "pt" ? log_pt : log_oa; }
};

/// All rows. The ablations' two files without a nominal sequence are taken for what they hold: in the
/// authors' repository, and in table II of the paper, the two scenarios are swapped.
const std::vector<PaperRow>& paper_rows();

/// The different experiments of the rows of these tables, table by table.
std::vector<evaluation::Experiment> paper_experiments(const std::vector<std::string>& tables, int laps_pt,
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
inline constexpr const char* undecided = "too few laps to decide";
inline constexpr const char* none = "not compared";
}  // namespace verdicts

/// Reference results of an experiment: logs of the authors, and of the paper's program in this simulator.
struct Reference {
  std::optional<evaluation::LapLog> log{}, released_log{};
  std::optional<evaluation::LogComparison> published{}, released{};
  std::string verdict{};  ///< one of `verdicts`, and figures
  std::string note{};     ///< reason of a difference, if known
};

/// The verdict on `published` and `released`; `collision_rate` is that of the measured laps.
std::string verdict_of(const Reference& reference, double collision_rate);

/// Files of the authors' repository, https://github.com/kohonda/proj-svg_mppi.
struct PaperFiles {
  std::filesystem::path course;    ///< folder of the map; empty: not a course of theirs
  std::filesystem::path logs;      ///< src/eval/log; empty: nothing to compare with
  std::vector<std::string> notes;  ///< sentences on files found and missing
};

/// Looks in a clone of that repository for the map and path of `course` and for the logs, which were driven
/// on Berlin and can be compared only with laps on it. An empty `clone` has neither. Throws IoError if it is
/// not a clone.
PaperFiles find_paper_files(const std::filesystem::path& clone, const std::string& course);

/// One per experiment. Throws IoError on a log that is there but cannot be read.
std::vector<Reference> find_references(const std::filesystem::path& logs,
                                       const std::vector<evaluation::Experiment>& experiments,
                                       const std::vector<evaluation::LapRow>& rows);

/// `published`, `paper_program`, `verdict` and `note` of an entry of a summary's results.
void add_reference(nlohmann::ordered_json& result, const Reference& reference);

}  // namespace slalom::tools
