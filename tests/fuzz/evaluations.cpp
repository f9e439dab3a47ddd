// Tables of laps, logs of other programs, and settings of evaluations.
#include <cmath>

#include "fuzz/target.hpp"
#include "json/json.hpp"
#include "slalom/evaluation/lap_log.hpp"
#include "slalom/evaluation/results.hpp"
#include "tools/evaluation/stored_evaluation.hpp"

namespace slalom::fuzz {
namespace {

const std::vector<evaluation::Experiment> experiments{
    {"mppi", {}, "oa", 5, 40}, {"svg_mppi", {{"svg_mppi.variance", "0.05"}}, "pt", 0, 2}};

evaluation::LapRow row(int experiment, int lap) {
  evaluation::LapRow row;
  row.experiment = experiment;
  row.lap = lap;
  row.seed = evaluation::lap_seed(0, lap, experiments[experiment].obstacles);
  row.finished = row.success = true;
  row.state_cost = 1.0 / (lap + 3);
  row.collision_points = "1.250:-3.000 0.500:2.000";
  return row;
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

/// Reads a table of laps and evaluates it. Throws IoError.
void read_laps(const std::string& file, bool truncated) {
  const auto rows = evaluation::read_rows(file, experiments, truncated, 0);
  for (const evaluation::LapRow& each : rows) {
    const std::string line = evaluation::csv_line(each, experiments);
    require(evaluation::csv_line(evaluation::parse_line(line, experiments), experiments) == line,
            "a row that is written reads back as the same");
  }
  evaluation::summarise(rows, experiments);
  evaluation::compare_pairs(rows, experiments);
}

// The checksums of the rows are made right before they are read, as a fuzzer does not find them.
const Target laps_target(
    "laps", 4096,
    []() -> Seeds {
      std::string rows;
      for (const auto& [experiment, lap] : {std::pair(0, 0), std::pair(0, 1), std::pair(1, 1)})
        rows += evaluation::csv_line(row(experiment, lap), experiments) + "\n";
      return {evaluation::checked_header() + "\n" + rows};
    },
    [](std::string_view bytes) {
      bool valid = true;
      for (const bool truncated : {false, true}) {
        is_valid([&] { read_laps(scratch_file("laps.csv", bytes), truncated); });
        valid &= is_valid([&] { read_laps(scratch_file("laps.csv", with_checksums(bytes)), truncated); });
      }
      return valid;
    });

const Target lap_log_target(
    "lap_log", 4096,
    []() -> Seeds {
      const std::string log =
          "seed,success,collision,timeout,state_cost,collision_cost,mean_calculation_time,max_calculation_"
          "time\n"
          "0,1,0,0,0.5,1.5,10,20\n10,0,2,1,1,4,12,18\n";
      std::string own = evaluation::csv_header(experiments) + "\n";
      evaluation::LapRow row;
      row.seed = evaluation::lap_seed(0, 0, 5);
      own += evaluation::csv_line(row, experiments) + "\n";
      return {log, "collision_cost, state_cost, success, collision\r\n0,1,1,0\r\n\r\n1e3,-2,0,7\r\n", own};
    },
    [](std::string_view bytes) {
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
    });

void check_json(std::string_view bytes) {
  const Json json = parse_json_or_null(bytes);
  const std::string text = json_text(json);
  require(json_text(parse_json(text)) == text, "JSON that is written reads back as the same");
  json.flatten();
}

/// Loads an evaluation and the arguments of its laps. Throws IoError.
void load(const std::filesystem::path& folder) {
  const tools::StoredEvaluation stored = tools::load_evaluation(folder);
  require(!stored.experiments.empty(), "an evaluation has experiments");
  for (const evaluation::Experiment& each : stored.experiments)
    require(each.laps >= 1 && each.obstacles >= 0, "an experiment has laps");
  tools::evaluation_arguments(stored, "");
}

/// Continues an evaluation whose settings are those stored. Throws IoError.
void resume(const std::filesystem::path& folder, const std::string& settings) {
  evaluation::Evaluation wanted;
  wanted.settings = settings;
  wanted.experiments = {{"mppi", {}, "oa", 5, 2}};
  require(evaluation::LapStore(folder, wanted, true).rows().empty(), "there were no laps");
}

// The checksum of the settings is made right before they are read, as a fuzzer does not find it.
const Target settings_target(
    "settings", 4096,
    []() -> Seeds {
      const Json settings = {
          {"course", "wren"},
          {"course_hash", "0123456789abcdef"},
          {"config", "default"},
          {"evaluation", "true"},
          {"latency_ms", 0.5},
          {"seed0", 3},
          {"experiments", Json::array({{{"method", "mppi"},
                                        {"set", "mppi.samples=32 mppi.variance=[0.1;0.2]"},
                                        {"scenario", "oa"},
                                        {"obstacles", 5},
                                        {"laps", 2}}})},
          {"options",
           {{"mppi", {{"samples", 32}, {"variance", Json::array({0.1, 0.2})}, {"shape", "narrow"}}}}}};
      return {settings.dump(), settings.dump(2),
              R"([1,-2.5e-3,18446744073709551615,null,true,"\u00e9",{"a":{}}])"};
    },
    [](std::string_view bytes) {
      check_json(bytes);
      scratch_file("laps.csv", evaluation::checked_header() + "\n");
      const std::string text(bytes);
      const bool is_object = parse_json_or_null(bytes).is_object();
      scratch_file("settings.json", is_object ? evaluation::with_checksum(text) : text);
      const bool valid = is_valid([] { load(scratch_folder().path()); });
      scratch_file("laps.journal.csv", evaluation::checked_header() + "\n");
      is_valid([&] { resume(scratch_folder().path(), is_object ? text : "{}"); });
      return valid;
    });

}  // namespace
}  // namespace slalom::fuzz
