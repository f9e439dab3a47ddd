#include <algorithm>
#include <cstdio>
#include <iostream>
#include <iterator>
#include <memory>

#include "json/json.hpp"
#include "tools/commands/commands.hpp"
#include "tools/evaluation/comparison.hpp"
#include "tools/evaluation/evaluation_job.hpp"
#include "tools/evaluation/stored_evaluation.hpp"
#include "tools/report/report.hpp"
#include "tools/terminal/json_output.hpp"

namespace slalom::tools {
namespace {

/// The world of `--conditions car`, as sweeps of `--set`.
constexpr const char* car_conditions[] = {"world.saturating_tyres=true", "world.localised=true",
                                          "world.range_noise=0.02",      "world.dropout=0.02",
                                          "world.latency=0.02",          "world.friction=0.5,0.7,1.0"};

struct EvalArguments {
  EvaluationArguments evaluation;
  std::vector<std::string> methods{"svg_mppi"}, scenarios{"oa"}, sweeps;
  int laps = 20;
  int obstacles = 5;
  bool report = false;
  std::string cluster, part;
  std::string conditions = "ideal";
};

int eval(const EvalArguments& arguments) {
  if (!arguments.part.empty()) {
    const std::string settings{std::istreambuf_iterator<char>(std::cin), {}};
    return drive_part(settings, arguments.part) ? 0 : 1;
  }
  if (arguments.evaluation.out.empty()) throw CommandLineError("--out", "is required");
  std::vector<std::string> sweeps = arguments.sweeps;
  if (arguments.conditions == "car") {
    sweeps.insert(sweeps.begin(), std::begin(car_conditions), std::end(car_conditions));
  } else if (arguments.conditions != "ideal") {
    throw CommandLineError("--conditions", arguments.conditions, "must be ideal or car");
  }
  const auto experiments =
      make_experiments(arguments.methods, arguments.scenarios, arguments.laps, arguments.obstacles, sweeps);
  Evaluated evaluated;
  if (!arguments.cluster.empty()) become_python("study");
  if (!run_evaluation(arguments.evaluation, experiments, evaluated))
    return arguments.evaluation.prepare ? 0 : 1;
  const auto summary = evaluated.summary();
  const std::string file = arguments.evaluation.out + "/summary.json";
  write_json(summary, file);
  std::FILE* words = arguments.evaluation.json == "-" ? stderr : stdout;
  if (arguments.report) {
    ReportChart chart{"methods", "Methods", {}};
    for (const auto& r : evaluated.results) {
      const auto& e = evaluated.experiment(r.experiment);
      auto row = std::find_if(chart.rows.begin(), chart.rows.end(),
                              [&](const ChartRow& other) { return other.name == e.label(); });
      if (row == chart.rows.end()) row = chart.rows.insert(row, {e.label()});
      (e.scenario == "pt" ? row->tracking : row->obstacles) = &r;
    }
    std::vector<std::string> sentences;
    for (const auto& c : evaluated.against_reference()) {
      const auto result = [&](int of) { return evaluated.results[static_cast<std::size_t>(of)]; };
      const auto &a = evaluated.experiment(c.a), &b = evaluated.experiment(c.b);
      sentences.push_back(a.scenario + ": " + verdict({a.label(), b.label()}, {result(c.a), result(c.b)}, c));
    }
    const Report report{
        "Methods compared",
        evaluated,
        {},
        sentences,
        {{"Paired comparison", pairs_table(evaluated)}, {"Methods", results_table(evaluated)}},
        {chart}};
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
  command.option("--methods", arguments->methods, "Methods, separated by commas", {.comma_separated = true});
  command.option("--scenario", arguments->scenarios,
                 "pt: path tracking, oa: obstacle avoidance; or both: pt,oa", {.comma_separated = true});
  command.option("--laps", arguments->laps, "Number of laps of each method in each scenario", {1, 1000000});
  command.option("--obstacles", arguments->obstacles, "Number of parked cars in scenario oa", {1, 1000});
  command.option(
      "--set", arguments->sweeps,
      "key=v1,v2,...: one experiment for each value, and for each combination of values if --set is "
      "repeated. Options of the simulated world, such as world.friction, can be varied, too; slalom "
      "options lists them");
  command.option(
      "--conditions", arguments->conditions,
      "car: tyres that saturate, sensor noise, a localised pose, 20 ms of latency, and one experiment "
      "each for friction 0.5, 0.7 and 1.0, which the planner is not told; ideal: none of these");
  command.flag("--report", arguments->report, "Also write report.html and its figures");
  add_evaluation_options(command, arguments->evaluation);
  command.option("--cluster", arguments->cluster,
                 "Address of a Dask scheduler whose workers drive (docs/studies.md)");
  command.flag("--prepare", arguments->evaluation.prepare, "Only make the folder, without laps, for a study");
  command.option(
      "--part", arguments->part,
      "EXPERIMENT:LAP ...: drive these laps of the settings.json on standard input for a study, and "
      "print their rows");
  command.examples({"eval --course eel --methods svg_mppi,mppi --laps 20 --out OUT --report",
                    "eval --course eel --set temperature=1,3,10 --laps 5 --out OUT"});
  command.action([arguments] { return eval(*arguments); });
}

}  // namespace slalom::tools
