#include <memory>

#include "slalom/core/error.hpp"
#include "tools/commands/commands.hpp"
#include "tools/evaluation/tuning_job.hpp"
#include "tools/ranks/ranks.hpp"
#include "tools/terminal/interrupt.hpp"
#include "tools/terminal/json_output.hpp"

namespace slalom::tools {
namespace {

int tune(const TuningArguments& arguments) {
  if (rank_count() > 1)
    throw IoError("mpirun", 0, "slalom tune runs in one process; use --jobs instead of mpirun");
  make_experiments({arguments.method}, arguments.scenarios, 1, arguments.obstacles,
                   {});  // throws on an unknown method or scenario
  std::FILE* words = arguments.evaluation.json == "-" ? stderr : stdout;
  TuningJob job(arguments);
  const InterruptFlag interrupt;
  if (!job.run(interrupt.raised(), words)) return 1;
  if (!arguments.evaluation.json.empty()) write_json(job.result(), arguments.evaluation.json);
  return 0;
}

}  // namespace

void declare_tune(Subcommand& command) {
  command.summary("Tune options by successive halving over paired seeds; validate on held-out seeds");
  const auto arguments = std::make_shared<TuningArguments>();
  add_method_option(command, arguments->method);
  std::string figures;
  for (const auto& [name, meaning] : evaluation::Objective::figures())
    figures += std::string(figures.empty() ? "" : "; ") + name + ": " + meaning;
  command
      .option("--objective", arguments->objective,
              "Objective to minimise, a mean over laps: a sum such as 'log_ms + 5*failures' of " + figures)
      .show_default();
  command
      .option("--set", arguments->set,
              "key=lo:hi, key=lo:hi:log or key=v1,v2,... is searched; key=value is set for all candidates")
      .required()
      .repeatable();
  command.option("--scenario", arguments->scenarios, "pt, oa or both: pt,oa")
      .comma_separated()
      .show_default();
  command.option("--obstacles", arguments->obstacles, "Number of parked cars in scenario oa")
      .range(1, 1000)
      .show_default();
  command.option("--budget", arguments->budget, "Number of laps of the search, without the held-out laps")
      .show_default();
  command
      .option("--laps", arguments->laps,
              "Number of laps of each candidate at first, in each scenario on each course")
      .show_default();
  command
      .option("--rounds", arguments->rounds,
              "Number of rounds; each further round searches ranges half as wide around the best candidate")
      .show_default();
  command
      .option("--held-out", arguments->held_out,
              "Number of held-out laps for the final result, in each scenario on each course")
      .show_default();
  add_evaluation_options(command, arguments->evaluation);
  command.find("--course").describe("Course names or folders, separated by commas");
  command.action([arguments] { return tune(*arguments); });
}

}  // namespace slalom::tools
