#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <system_error>

#include "src/evaluation/json.hpp"
#include "tools/commands/commands.hpp"
#include "tools/soak/soak.hpp"
#include "tools/terminal/interrupt.hpp"
#include "tools/terminal/json_output.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;

/// A folder that goes with its object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (fs::temp_directory_path() / "slalom-soak.XXXXXX").string();
    if (!mkdtemp(pattern.data())) throw std::system_error(errno, std::generic_category(), pattern);
    path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

struct SoakCommandArguments {
  SoakArguments soak;
  std::string json;
};

void print(std::FILE* out, const SoakResult& result) {
  std::fprintf(out, "\n%-14s %6s %9s\n", "trial", "runs", "failures");
  for (const TrialResult* trial : {&result.laps, &result.faults, &result.stalls, &result.kills}) {
    std::fprintf(out, "%-14s %6d %9zu\n", trial->name.c_str(), trial->runs, trial->failures.size());
    for (const std::string& failure : trial->failures) std::fprintf(out, "  %s\n", failure.c_str());
  }
  constexpr double mebibyte = 1 << 20;
  std::fprintf(out,
               "%d sensor faults; the planner planned again %.3f s after them at the latest\n"
               "%ld of %ld control steps took longer than the control period, the longest %.1f ms\n"
               "memory %.1f MiB after the first rounds, %.1f MiB at the end; descriptors %d and %d\n%s\n",
               result.spoilt, result.slowest_return, result.late_ticks, result.ticks,
               1e3 * result.longest_tick, static_cast<double>(result.memory_first) / mebibyte,
               static_cast<double>(result.memory_last) / mebibyte, result.descriptors_first,
               result.descriptors_last,
               result.interrupted ? "interrupted"
               : result.passed()  ? "passed"
                                  : "failed");
}

Json trial_json(const TrialResult& trial) {
  return {{"runs", trial.runs}, {"failures", trial.failures}};
}

int soak(const SoakCommandArguments& arguments) {
  std::FILE* words = arguments.json == "-" ? stderr : stdout;
  const InterruptFlag interrupt;
  const TemporaryFolder folder;
  const SoakResult result = soak(arguments.soak, folder.path(), words, interrupt.raised());
  print(words, result);
  if (!arguments.json.empty())
    write_json({{"passed", result.passed()},
                {"interrupted", result.interrupted},
                {"seconds", result.seconds},
                {"laps", trial_json(result.laps)},
                {"sensor_faults", trial_json(result.faults)},
                {"stalls", trial_json(result.stalls)},
                {"kills", trial_json(result.kills)},
                {"spoilt_periods", result.spoilt},
                {"slowest_return_s", result.slowest_return},
                {"ticks", result.ticks},
                {"late_ticks", result.late_ticks},
                {"longest_tick_s", result.longest_tick},
                {"memory_bytes", {result.memory_first, result.memory_last}},
                {"descriptors", {result.descriptors_first, result.descriptors_last}}},
               arguments.json);
  return result.passed() ? 0 : 1;
}

}  // namespace

void declare_soak(Subcommand& command) {
  command.summary("Drive for hours, disturb sensors, clock and processes, and report what breaks");
  const auto arguments = std::make_shared<SoakCommandArguments>();
  ScenarioArguments& scenario = arguments->soak.scenario;
  scenario.course = "wren";
  scenario.obstacles = 2;
  command.option("--hours", arguments->soak.hours, "How long; every trial runs at least once")
      .range(0.0, 10000.0)
      .show_default();
  command.option("--course", scenario.course, "Course name or folder").show_default();
  command.option("--config", scenario.config, config_help).show_default();
  add_method_option(command, arguments->soak.method);
  command
      .option("--set", scenario.set,
              "section.option=value, or option=value for the method's own; may be repeated")
      .repeatable();
  command.option("--obstacles", scenario.obstacles, "Number of parked cars on the course")
      .range(1, 1000)
      .show_default();
  command.option("--seed", arguments->soak.seed, "Seed of the laps and of the disturbances").show_default();
  command.option("--json", arguments->json,
                 "Write the result as JSON to this file, or to standard output: -");
  command.action([arguments] { return soak(*arguments); });
}

}  // namespace slalom::tools
