#include "tools/evaluation/paper_program.hpp"

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

}  // namespace slalom::tools
