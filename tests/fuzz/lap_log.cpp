// Logs of laps that other programs have written.
#include "slalom/evaluation/lap_log.hpp"

#include <cmath>

#include "fuzz/target.hpp"
#include "slalom/core/error.hpp"

namespace slalom::fuzz {
namespace {

std::vector<std::string> seeds() {
  const std::string log =
      "seed,success,collision,timeout,state_cost,collision_cost,mean_calculation_time,max_calculation_time\n"
      "0,1,0,0,0.5,1.5,10,20\n10,0,2,1,1,4,12,18\n";
  const std::vector<evaluation::Experiment> experiments{{"mppi", {}, "oa", 5, 2}};
  std::string own = evaluation::csv_header(experiments) + "\n";
  evaluation::LapRow row;
  row.seed = evaluation::lap_seed(0, 0, 5);
  own += evaluation::csv_line(row, experiments) + "\n";
  return {log, "collision_cost, state_cost, success, collision\r\n0,1,1,0\r\n\r\n1e3,-2,0,7\r\n", own};
}

bool run(std::string_view bytes) {
  try {
    const evaluation::LapLog log = evaluation::read_lap_log(scratch_file("log.csv", bytes));
    require(log.laps >= 1 && log.ms.size() == static_cast<std::size_t>(log.laps), "a log has its laps");
    require(log.successes >= 0 && log.successes <= log.laps && log.timeouts >= 0 &&
                log.timeouts <= log.laps && log.collisions >= 0,
            "counts are within the laps");
    for (const double ms : log.ms) require(std::isfinite(ms), "costs are finite");
    require(std::isfinite(evaluation::mean(log.ms)), "the mean of the costs is finite");
    for (const auto& time : {log.solve_ms_mean, log.solve_ms_max})
      require(!time || std::isfinite(*time), "times are finite");
    return true;
  } catch (const IoError&) {
    return false;
  }
}

const Target target("lap_log", 4096, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
