#include <memory>

#include "src/evaluation/json.hpp"
#include "tools/commands/commands.hpp"
#include "tools/evaluation/evaluation_check.hpp"
#include "tools/evaluation/evaluation_job.hpp"
#include "tools/report/report.hpp"
#include "tools/terminal/json_output.hpp"

namespace slalom::tools {
namespace {

struct EvalArguments {
  EvaluationArguments evaluation;
  std::vector<std::string> methods{"svg_mppi"}, scenarios{"oa"}, sweeps;
  int laps = 20;
  int obstacles = 5;
  bool report = false;
  std::string check;
  int again = 3;
};

int eval(const EvalArguments& arguments) {
  if (!arguments.check.empty()) return check_evaluation(arguments.check, arguments.again);
  if (arguments.evaluation.out.empty()) throw CommandLineError("--out", "is required");
  const auto experiments = make_experiments(arguments.methods, arguments.scenarios, arguments.laps,
                                            arguments.obstacles, arguments.sweeps);
  Evaluated evaluated;
  if (!run_evaluation(arguments.evaluation, experiments, evaluated)) return 1;
  const auto summary = evaluated.summary();
  const std::string file = arguments.evaluation.out + "/summary.json";
  write_json(summary, file);
  std::FILE* words = arguments.evaluation.json == "-" ? stderr : stdout;
  if (arguments.report) {
    Report report{"Methods compared", evaluated, {}, {}, {}};
    for (const auto& r : evaluated.results) {
      const auto& e = evaluated.evaluation.experiments[static_cast<std::size_t>(r.experiment)];
      report.rows.push_back({"methods", e.label(), "", r.experiment});
    }
    write_report(report, arguments.evaluation.out);
  }
  print_results(evaluated, words);
  std::fprintf(words, "%s\n", file.c_str());
  if (arguments.report) std::fprintf(words, "%s/report.html\n", arguments.evaluation.out.c_str());
  if (!arguments.evaluation.json.empty()) write_json(summary, arguments.evaluation.json);
  return 0;
}

}  // namespace

void declare_eval(Subcommand& command) {
  command.summary("Evaluate methods over many laps, with confidence intervals and paired tests");
  const auto arguments = std::make_shared<EvalArguments>();
  command.option("--methods", arguments->methods, "Methods, separated by commas")
      .comma_separated()
      .show_default();
  command
      .option("--scenario", arguments->scenarios, "pt: path tracking, oa: obstacle avoidance; or both: pt,oa")
      .comma_separated()
      .show_default();
  command.option("--laps", arguments->laps, "Number of laps of each method in each scenario")
      .range(1, 1000000)
      .show_default();
  command.option("--obstacles", arguments->obstacles, "Number of parked cars in scenario oa")
      .range(1, 1000)
      .show_default();
  command
      .option("--set", arguments->sweeps,
              "key=v1,v2,...: one experiment for each value, and for each combination of values if --set is "
              "repeated. Options of the simulated world, such as world.friction, can be varied, too; slalom "
              "options lists them")
      .repeatable();
  command.flag("--report", arguments->report, "Also write report.html and its figures");
  add_evaluation_options(command, arguments->evaluation);
  const Option check =
      command.option("--check", arguments->check,
                     "Verify this folder of an evaluation instead: checksums, seeds, and that laps repeat");
  command.option("--again", arguments->again, "With --check: number of laps that are driven again")
      .range(0, 1000000)
      .show_default()
      .needs(check);
  command.find("--out").required(false).excludes(check);
  command.action([arguments] { return eval(*arguments); });
}

}  // namespace slalom::tools
