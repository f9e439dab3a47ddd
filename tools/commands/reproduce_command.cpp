
#include "json/json.hpp"
#include "tools/command_line/words.hpp"
#include "tools/commands/commands.hpp"
#include "tools/evaluation/claims.hpp"
#include "tools/evaluation/evaluation_job.hpp"
#include "tools/report/report.hpp"
#include "tools/terminal/json_output.hpp"
#include "tools/terminal/text_table.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* paper_course = "berlin";  // with --paper, unless --course is given
constexpr const char* other_course = "stag";    // without

struct ReproduceArguments {
  EvaluationArguments evaluation;
  std::string paper;
  std::vector<std::string> tables;
  int laps_pt = 30, laps_oa = 100, obstacles = 5;
  bool quick = false, claims = false, course_given = false;
};

/// The rows of a table beside the authors' results.
TextTable shown_table(const PaperTable& table, const Evaluated& evaluated,
                      const std::vector<Reference>& references) {
  TextTable shown({"<row", "<scenario", "laps", "MS (95 %)", "published MS", "released", "collision rate, %",
                   "published", "<verdict"});
  for (const char* scenario : {"pt", "oa"}) {
    for (const PaperRow& row : paper_rows()) {
      if (row.table != table.name) continue;
      for (const auto& r : evaluated.results) {
        const auto index = static_cast<std::size_t>(r.experiment);
        const auto& e = evaluated.evaluation.experiments[index];
        if (e.scenario != scenario || !drives(e, row)) continue;
        const auto &theirs = references[index].published, &released = references[index].released;
        shown.add({row.name, scenario, std::to_string(r.laps), mean_cell(r.ms_mean, r.ms_ci, r.laps),
                   theirs ? mean_cell(theirs->ms_mean, theirs->ms_ci, evaluation::fewest_laps) : "-",
                   released ? formatted("%.3g", released->ms_mean) : "-",
                   rate_cell(r.collision_rate, r.collision_rate_ci),
                   theirs ? rate_cell(theirs->collision_rate, theirs->collision_rate_ci) : "-",
                   references[index].verdict});
      }
    }
  }
  return shown;
}

ReportChart chart_of(const PaperTable& table, const Evaluated& evaluated) {
  ReportChart chart{table.figure, table.title, {}};
  for (const PaperRow& row : paper_rows()) {
    if (row.table != table.name) continue;
    ChartRow& shown = chart.rows.emplace_back(ChartRow{row.name});
    for (const auto& r : evaluated.results)
      if (const auto& e = evaluated.experiment(r.experiment); drives(e, row))
        (e.scenario == "pt" ? shown.tracking : shown.obstacles) = &r;
  }
  return chart;
}

int reproduce(ReproduceArguments arguments) {
  for (const std::string& table : arguments.tables)
    if (!find_table(table))
      throw CommandLineError("--tables", table, "must be table1, table2 or covariances");
  std::FILE* words = arguments.evaluation.json == "-" ? stderr : stdout;
  std::string& course = arguments.evaluation.scenario.course;
  if (!arguments.course_given) course = arguments.paper.empty() ? other_course : paper_course;
  const PaperFiles files = for_option(
      "--paper", [&] { return find_paper_files(arguments.paper, fs::path(course).filename().string()); });
  if (!files.course.empty()) course = files.course.string();
  const auto tenth = [&](int laps) { return arguments.quick ? (laps + 9) / 10 : laps; };
  const auto experiments = paper_experiments(arguments.tables, tenth(arguments.laps_pt),
                                             tenth(arguments.laps_oa), arguments.obstacles);
  for (const std::string& note : files.notes) std::fprintf(words, "note: %s\n", note.c_str());
  std::fflush(words);
  if (arguments.claims) {
    const Json claims = claims_json(files.logs, {}, {});
    print_claims(claims, words);
    if (!arguments.evaluation.json.empty()) write_json(claims, arguments.evaluation.json);
    return 0;
  }
  // Reports an unreadable log now, not after hours of driving.
  find_references(files.logs, experiments, {});

  Evaluated evaluated;
  if (!run_evaluation(arguments.evaluation, experiments, evaluated)) return 1;
  const auto references = find_references(files.logs, experiments, evaluated.rows);
  auto summary = evaluated.summary();
  for (std::size_t i = 0; i < references.size(); ++i) add_reference(summary["results"][i], references[i]);
  summary["notes"] = files.notes;
  summary["claims"] = claims_json(files.logs, experiments, evaluated.rows);
  const std::string file = arguments.evaluation.out + "/summary.json";
  write_json(summary, file);
  Report report{"Reproduction of the paper's simulation section", evaluated, references, files.notes, {}, {}};
  for (const std::string& name : arguments.tables) {
    const PaperTable& table = *find_table(name);
    report.tables.emplace_back(table.title, shown_table(table, evaluated, references));
    report.charts.push_back(chart_of(table, evaluated));
    std::fprintf(words, "\n%s\n", table.title);
    report.tables.back().second.print(words);
  }
  report.tables.emplace_back("Paired comparison", pairs_table(evaluated));
  write_report(report, arguments.evaluation.out);
  print_claims(summary["claims"], words);
  std::fprintf(words, "\n%s\n%s/report.html\n", file.c_str(), arguments.evaluation.out.c_str());
  if (!arguments.evaluation.json.empty()) write_json(summary, arguments.evaluation.json);
  return 0;
}

}  // namespace

void declare_reproduce(Subcommand& command) {
  command.summary("Reproduce the simulation section of the paper and compare it with the authors' logs");
  const auto arguments = std::make_shared<ReproduceArguments>();
  auto& scenario = arguments->evaluation.scenario;
  scenario.course = paper_course;
  scenario.config = scenario.evaluation = "published";
  add_evaluation_options(command, arguments->evaluation);
  command.option(
      "--paper", arguments->paper,
      "Clone of the authors' repository, github.com/kohonda/proj-svg_mppi, for its courses and logs; "
      "without it, the laps are driven on stag, unless --course is given, and compared with nothing");
  for (const PaperTable& table : paper_tables) arguments->tables.push_back(table.name);
  command.option("--tables", arguments->tables, "Tables, separated by commas: table1, table2, covariances",
                 {.comma_separated = true});
  command.option("--laps-pt", arguments->laps_pt, "Number of path-tracking laps of each row", {1, 1000000});
  command.option("--laps-oa", arguments->laps_oa, "Number of obstacle-avoidance laps of each row",
                 {1, 1000000});
  command.flag("--quick", arguments->quick, "Drive a tenth of the laps");
  command.flag("--claims", arguments->claims,
               "Only test the paper's claims on the logs of --paper, without driving");
  command.option("--set", scenario.set, "section.option=value, for all rows; may be repeated");
  command.examples({"reproduce --paper path/to/proj-svg_mppi --quick --out OUT"});
  command.action([arguments, &command] {
    arguments->course_given = command.given("--course");
    if (arguments->claims && arguments->paper.empty()) throw CommandLineError("--claims", "needs --paper");
    if (arguments->evaluation.out.empty() && !arguments->claims)
      throw CommandLineError("--out", "is required");
    return reproduce(*arguments);
  });
}

}  // namespace slalom::tools
