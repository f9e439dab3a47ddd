#pragma once

#include "slalom/evaluation/lap_log.hpp"
#include "tools/evaluation/reproduction.hpp"

/// The statements of Honda et al. (ICRA 2024, section V-B) that compare two methods, tested on laps.
namespace slalom::tools {

/// A claim: one row is better than another in a scenario.
struct Claim {
  const char* text;            ///< the statement
  const char *better, *worse;  ///< PaperRow::released of the two rows
  const char* scenario;        ///< "pt" or "oa"
  bool collisions = false;     ///< whether it is about the collision rate; if not, about the MS
};
const std::vector<Claim>& paper_claims();

/// The test of a claim on laps of both rows with the same seeds.
struct ClaimTest {
  double better = 0, worse = 0;  ///< mean MS, or collisions per obstacle, of the two rows
  double p = 1;                  ///< Wilcoxon's signed-rank test
  int laps = 0;                  ///< number of pairs
  /// "holds" or "reversed" if p < 0.05, else "not shown".
  const char* verdict() const;
};

/// Tests a claim. Empty if one of the rows has no laps, or there is no pair.
std::optional<ClaimTest> test_claim(const Claim& claim, const evaluation::LapLog& better,
                                    const evaluation::LapLog& worse);

/// The claims tested on the authors' logs and on measured laps; each as an object with `claim`, `figure`,
/// `scenario`, and the tests `logs` and `slalom`, which may be null.
nlohmann::ordered_json claims_json(const std::filesystem::path& logs,
                                   const std::vector<evaluation::Experiment>& experiments,
                                   const std::vector<evaluation::LapRow>& rows);

/// Prints them as a table.
void print_claims(const nlohmann::ordered_json& claims, std::FILE* out);

/// Laps of the program that Honda et al. released (https://github.com/kohonda/proj-svg_mppi), driven in
/// Slalom's simulator: its own solver sources, one thread, in the place of Slalom's solver, on Berlin under
/// `--evaluation published`. So only the solver differs from the laps of `reproduce`, without the data races
/// and the asynchrony of the authors' logs. The solver is kept from lap to lap, as the program's node does.
///
/// `row` is a PaperRow's `released`, `scenario` "pt" or "oa". Empty if no lap of the row was driven.
std::optional<evaluation::LapLog> paper_program_laps(const std::string& row, const std::string& scenario);

}  // namespace slalom::tools
