#include <memory>

#include "slalom/core/error.hpp"
#include "tools/commands/commands.hpp"
#include "tools/evaluation/ranks.hpp"
#include "tools/evaluation/tuning_job.hpp"
#include "tools/terminal/interrupt.hpp"
#include "tools/terminal/json_output.hpp"

namespace slalom::tools {
namespace {

int run(const TuningArguments& arguments) {
  if (rank_count() > 1)
    throw IoError("mpirun", 0, "slalom tune drives its laps on the threads of one process: --jobs");
  make_experiments({arguments.method}, arguments.scenarios, 1, arguments.obstacles, {});  // refuses bad words
  std::FILE* words = arguments.evaluation.json == "-" ? stderr : stdout;
  TuningJob job(arguments);
  const InterruptFlag interrupt;
  if (!job.run(interrupt.raised(), words)) return 1;
  if (!arguments.evaluation.json.empty()) write_json(job.result(), arguments.evaluation.json);
  return 0;
}

}  // namespace

void declare_tune(Command& command) {
  command.summary(
      "Search options over paired seeds: successive halving, held-out seeds for the final figure");
  const auto arguments = std::make_shared<TuningArguments>();
  add_method_option(command, arguments->method);
  std::string figures;
  for (const auto& [name, meaning] : evaluation::Objective::figures())
    figures += std::string(figures.empty() ? "" : "; ") + name + ": " + meaning;
  command
      .option("--objective", arguments->objective,
              "What is made small, a mean over laps: a sum like 'log_ms + 5*failures' of " + figures)
      .show_default();
  command
      .option("--set", arguments->set,
              "key=lo:hi, key=lo:hi:log or key=v1,v2,...: search it; key=value: set it for all")
      .required()
      .repeatable();
  command.option("--scenario", arguments->scenarios, "pt, oa or both: pt,oa")
      .comma_separated()
      .show_default();
  command.option("--obstacles", arguments->obstacles, "Parked cars a lap in scenario oa")
      .range(1, 1000)
      .show_default();
  command.option("--budget", arguments->budget, "Laps of the search; held-out laps come on top")
      .show_default();
  command
      .option("--laps", arguments->laps,
              "Of every candidate to begin with, in every scenario on every course")
      .show_default();
  command
      .option("--rounds", arguments->rounds,
              "Each but the first searches a box half as wide round the best so far")
      .show_default();
  command
      .option("--held-out", arguments->held_out,
              "Laps for the final figure, in every scenario on every course, on seeds of their own")
      .show_default();
  add_evaluation_options(command, arguments->evaluation);
  command.find("--course").describe("Courses by name, or their folders, separated by commas");
  command.action([arguments] { return run(*arguments); });
}

}  // namespace slalom::tools
