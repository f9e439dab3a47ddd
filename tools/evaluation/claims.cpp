#include "tools/evaluation/claims.hpp"

#include "json/json.hpp"
#include "tools/command_line/words.hpp"
#include "tools/terminal/text_table.hpp"

namespace slalom::tools {
namespace {

struct ProgramLaps {
  const char* row;
  const char* scenario;
  std::vector<double> ms;  ///< per lap
  int collisions = 0;      ///< collisions of all laps
};

/// Measured figures: one MS per lap. docs/logbook/evaluation.md says how they were driven.
const std::vector<ProgramLaps>& table() {
  static const std::vector<ProgramLaps> laps = {
      {"mppi_0.025", "pt", {5.75563, 5.75884, 5.74275}},
      {"mppi_0.05", "pt", {2.43364}},
      {"mppi_0.05", "oa", {37.77305, 18.67430, 22.75302, 2.90122}, 3},
      {"mppi_0.075", "pt", {1.35844, 1.36808, 1.35916}},
      {"reverse_mppi", "pt", {0.21452}},
      {"sv_mpc", "pt", {10.99210, 13.32254, 15.73530}},
      {"sv_mpc", "oa", {21.02983, 31.94535, 16.11946, 19.36701}, 4},
      {"svg_mppi", "pt", {0.18902, 0.18698}},
      {"svg_mppi",
       "oa",
       {11.65223, 8.63773, 9.23987, 0.83534, 1.18754, 8.92777, 2.77360, 3.90656, 2.97830, 7.07375},
       6},
      {"ns_0.005", "pt", {1.00403, 1.57729}},
      {"ns_0.01", "pt", {0.31208, 0.30173, 0.2894, 0.3333, 0.3399, 0.2979}},
      {"ns_0.015", "pt", {0.21550, 0.22849, 0.23160}},
      {"ns_0.02", "pt", {0.19791, 0.19384, 0.1940, 0.1959, 0.2043, 0.1977, 0.1960, 0.2079}},
      {"ns_0.03", "pt", {0.17968, 0.17965, 0.17813, 0.18102}},
      {"ns_0.05", "pt", {0.17708, 0.17059}},
      {"ns_0.1",
       "oa",
       {19.71375, 10.40067, 21.69318, 1.18805, 4.92578, 10.54301, 21.30562, 10.41043, 11.97518, 20.23505},
       0},
  };
  return laps;
}

using namespace evaluation;

constexpr int obstacles_of_a_lap = 5;

const PaperRow& row_of(const std::string& released) {
  const auto& rows = paper_rows();
  return *std::find_if(rows.begin(), rows.end(), [&](const PaperRow& r) { return r.released == released; });
}

std::optional<LapLog> logged_laps(const std::filesystem::path& logs, const Claim& claim,
                                  const char* released) {
  const std::filesystem::path file = logs / row_of(released).log(claim.scenario);
  if (logs.empty() || !std::filesystem::exists(file)) return {};
  return read_lap_log(file);
}

std::optional<LapLog> measured_laps(const std::vector<Experiment>& experiments,
                                    const std::vector<LapRow>& rows, const Claim& claim,
                                    const char* released) {
  LapLog laps;
  for (const LapRow& row : rows) {
    const Experiment& e = experiments[static_cast<std::size_t>(row.experiment)];
    if (e.scenario != claim.scenario || !drives(e, row_of(released))) continue;
    ++laps.laps;
    laps.seeds.push_back(static_cast<double>(row.seed));
    laps.ms.push_back(row.mean_sequence_cost());
    laps.lap_collisions.push_back(row.collisions);
  }
  return laps.laps > 0 ? std::optional(laps) : std::nullopt;
}

Json test_json(const Claim& claim, const std::optional<LapLog>& better, const std::optional<LapLog>& worse) {
  const auto test = better && worse ? test_claim(claim, *better, *worse) : std::nullopt;
  if (!test) return nullptr;
  return {{"better", test->better},
          {"worse", test->worse},
          {"p", test->p},
          {"laps", test->laps},
          {"verdict", test->verdict()}};
}

std::string test_text(const Json& test, bool collisions) {
  if (test.is_null()) return "-";
  const double scale = collisions ? 100 : 1, p = test["p"].get<double>();
  return formatted(p < 1e-3 ? "%.3g, %.3g, p %.0e, %s" : "%.3g, %.3g, p %.3f, %s",
                   scale * test["better"].get<double>(), scale * test["worse"].get<double>(), p,
                   test["verdict"].get<std::string>().c_str());
}

}  // namespace

std::optional<evaluation::LapLog> paper_program_laps(const std::string& row, const std::string& scenario) {
  const auto found = std::find_if(table().begin(), table().end(), [&](const ProgramLaps& laps) {
    return row == laps.row && scenario == laps.scenario;
  });
  if (found == table().end()) return {};
  return evaluation::LapLog{.file = "the paper's program, " + row + ", " + scenario,
                            .laps = static_cast<int>(found->ms.size()),
                            .collisions = found->collisions,
                            .ms = found->ms};
}

const std::vector<Claim>& paper_claims() {
  static const std::vector<Claim> claims = {
      {"a lower covariance of MPPI: lower MS among obstacles", "mppi_0.025", "mppi_0.1", "oa"},
      {"a lower covariance of MPPI: fewer collisions", "mppi_0.025", "mppi_0.1", "oa", true},
      {"a lower covariance of MPPI: higher MS in path tracking", "mppi_0.1", "mppi_0.025", "pt"},
      {"Reverse MPPI outperforms MPPI in path tracking", "reverse_mppi", "mppi_0.1", "pt"},
      {"Reverse MPPI underperforms among obstacles", "mppi_0.1", "reverse_mppi", "oa"},
      {"SV-MPC outperforms MPPI among obstacles", "sv_mpc", "mppi_0.025", "oa"},
      {"SV-MPC has fewer collisions than MPPI", "sv_mpc", "mppi_0.025", "oa", true},
      {"SV-MPC underperforms in path tracking", "mppi_0.1", "sv_mpc", "pt"},
      {"SVG-MPPI is superior in path tracking (to Reverse MPPI)", "svg_mppi", "reverse_mppi", "pt"},
      {"SVG-MPPI is superior among obstacles (to SV-MPC)", "svg_mppi", "sv_mpc", "oa"},
      {"SVG-MPPI has the lowest collision rate (against SV-MPC)", "svg_mppi", "sv_mpc", "oa", true},
      {"SVG-MPPI has the lowest collision rate (against NS)", "svg_mppi", "ns_0.075", "oa", true},
      {"SVG-MPPI has the lowest collision rate (against NS 0.005)", "svg_mppi", "ns_0.005", "oa", true},
      {"NS outperforms MPPI in path tracking", "ns_0.075", "mppi_0.075", "pt"},
      {"NS outperforms MPPI among obstacles", "ns_0.075", "mppi_0.075", "oa"},
      {"AC is better than NS among obstacles", "ac", "ns_0.075", "oa"},
      {"AC diminishes path tracking (against MPPI)", "mppi_0.075", "ac", "pt"},
      {"SVG-MPPI is best among obstacles (against NS)", "svg_mppi", "ns_0.075", "oa"},
      {"SVG-MPPI is best among obstacles (against NS 0.005)", "svg_mppi", "ns_0.005", "oa"},
      {"AC slightly hinders path tracking (NS against SVG-MPPI)", "ns_0.075", "svg_mppi", "pt"},
  };
  return claims;
}

const char* ClaimTest::verdict() const {
  if (p >= 0.05) return "not shown";
  return better < worse ? "holds" : "reversed";
}

std::optional<ClaimTest> test_claim(const Claim& claim, const LapLog& better, const LapLog& worse) {
  ClaimTest test;
  std::vector<double> differences;
  const double share = claim.collisions ? 1.0 / obstacles_of_a_lap : 1;
  const auto& theirs = claim.collisions ? worse.lap_collisions : worse.ms;
  const auto& ours = claim.collisions ? better.lap_collisions : better.ms;
  for (std::size_t i = 0; i < better.seeds.size(); ++i) {
    const auto found = std::find(worse.seeds.begin(), worse.seeds.end(), better.seeds[i]);
    if (found == worse.seeds.end()) continue;
    const double other = theirs[static_cast<std::size_t>(found - worse.seeds.begin())];
    test.better += share * ours[i];
    test.worse += share * other;
    differences.push_back(ours[i] - other);
  }
  if (differences.empty()) return {};
  test.laps = static_cast<int>(differences.size());
  test.better /= test.laps;
  test.worse /= test.laps;
  test.p = wilcoxon_p(differences);
  return test;
}

Json claims_json(const std::filesystem::path& logs, const std::vector<Experiment>& experiments,
                 const std::vector<LapRow>& rows) {
  Json claims = Json::array();
  for (const Claim& claim : paper_claims())
    claims.push_back({{"claim", claim.text},
                      {"figure", claim.collisions ? "collision rate" : "MS"},
                      {"scenario", claim.scenario},
                      {"logs", test_json(claim, logged_laps(logs, claim, claim.better),
                                         logged_laps(logs, claim, claim.worse))},
                      {"slalom", test_json(claim, measured_laps(experiments, rows, claim, claim.better),
                                           measured_laps(experiments, rows, claim, claim.worse))}});
  return claims;
}

void print_claims(const Json& claims, std::FILE* out) {
  std::fprintf(out,
               "\nClaims: MS or collision rate (%%) of the better and the worse row, p value, verdict\n");
  TextTable table({"<claim", "<authors' logs", "<Slalom"});
  for (const Json& claim : claims) {
    const bool collisions = claim["figure"] == "collision rate";
    table.add({claim["claim"], test_text(claim["logs"], collisions), test_text(claim["slalom"], collisions)});
  }
  table.print(out);
}

}  // namespace slalom::tools
