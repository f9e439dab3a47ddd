// Tables of laps: laps.csv and the journal. The checksums of the input's rows are made right before it is
// read, as a fuzzer does not find them.
#include "fuzz/target.hpp"
#include "slalom/core/error.hpp"
#include "slalom/evaluation/results.hpp"

namespace slalom::fuzz {
namespace {

const std::vector<evaluation::Experiment> experiments{
    {"mppi", {}, "oa", 5, 40}, {"svg_mppi", {{"svg_mppi.variance", "0.05"}}, "pt", 0, 2}};

evaluation::LapRow row(int experiment, int lap) {
  evaluation::LapRow row;
  row.experiment = experiment;
  row.lap = lap;
  row.seed = evaluation::lap_seed(0, lap, experiments[static_cast<std::size_t>(experiment)].obstacles);
  row.finished = row.success = true;
  row.state_cost = 1.0 / (lap + 3);
  row.contact_points = "1.250:-3.000 0.500:2.000";
  return row;
}

std::vector<std::string> seeds() {
  std::string rows;
  for (const auto& [experiment, lap] : {std::pair(0, 0), std::pair(0, 1), std::pair(1, 1)})
    rows += evaluation::csv_line(row(experiment, lap), experiments) + "\n";
  return {evaluation::checked_header() + "\n" + rows};
}

/// The rows with their checksums.
std::string with_checksums(std::string_view bytes) {
  std::string table;
  while (!bytes.empty()) {
    const std::size_t end = bytes.find('\n');
    std::string line(bytes.substr(0, end));
    if (!table.empty()) line = evaluation::checked_line(line);
    table += line;
    if (end == std::string_view::npos) break;
    table += '\n';
    bytes.remove_prefix(end + 1);
  }
  return table;
}

bool read(const std::string& file, bool truncated) {
  try {
    const auto rows = evaluation::read_rows(file, experiments, truncated, 0);
    for (const evaluation::LapRow& each : rows) {
      const std::string line = evaluation::csv_line(each, experiments);
      require(evaluation::csv_line(evaluation::parse_line(line, experiments), experiments) == line,
              "a row that is written reads back as the same");
    }
    evaluation::summarise(rows, experiments);
    evaluation::compare_pairs(rows, experiments);
    return true;
  } catch (const IoError&) {
    return false;
  }
}

bool run(std::string_view bytes) {
  bool valid = true;
  for (const bool truncated : {false, true}) {
    read(scratch_file("laps.csv", bytes), truncated);
    valid &= read(scratch_file("laps.csv", with_checksums(bytes)), truncated);
  }
  return valid;
}

const Target target("laps", 4096, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
