#include "tools/evaluation/evaluation_job.hpp"

#include <cstdio>
#include <thread>

#include "slalom/core/instruction_set.hpp"
#include "slalom/core/version.hpp"
#include "src/evaluation/json.hpp"
#include "tools/command_line/command.hpp"
#include "tools/command_line/words.hpp"
#include "tools/evaluation/build_id.hpp"
#include "tools/terminal/interrupt.hpp"
#include "tools/terminal/progress.hpp"

namespace slalom::tools {

namespace {

using namespace evaluation;

Json settings_of(const EvaluationArguments& arguments, const Scenario& scenario,
                 const std::vector<Experiment>& experiments) {
  Json options, list = Json::array();
  for (const Experiment& e : experiments) {
    options.update(options_json(scenario.configuration, e.method));
    if (e.has_planning_opponents())
      options.update(options_json(scenario.configuration, evaluation::Driver{}.method));
    list.push_back({{"method", e.method},
                    {"scenario", e.scenario},
                    {"set", e.set_text()},
                    {"obstacles", e.obstacles},
                    {"laps", e.laps}});
  }
  Json settings{{"version", version()},
                {"instruction_set", simd::name(simd::active_target())},
                {"course", scenario.environment->course.name},
                {"course_hash", course_hash(*scenario.environment)},
                {"config", arguments.scenario.config},
                {"evaluation", arguments.scenario.evaluation},
                {"latency_ms", arguments.scenario.latency_ms},
                {"seed0", arguments.seed0},
                {"experiments", list},
                {"options", options}};
  if (arguments.scenario.hardware) settings["hardware"] = true;
  if (const std::string folder = folder_without_name(scenario); !folder.empty())
    settings["course_folder"] = folder;
  return settings;
}

Json rate_json(const std::optional<double>& rate) {
  return rate ? Json(*rate) : Json(nullptr);
}
Json interval_json(const std::optional<Interval>& i) {
  return i ? Json{i->low, i->high} : Json(nullptr);
}

/// Writes the figures of an evaluation's tracker.
Json tracking_json(const TrackingFigures& t, int laps) {
  const auto rate = [](int part, int whole) {
    return Json{{"rate", whole > 0 ? Json(static_cast<double>(part) / whole) : Json(nullptr)},
                {"detected", part},
                {"in_view", whole}};
  };
  return {{"detection", rate(t.detected, t.in_view)},
          {"detection_after_200_ms", rate(t.long_detected, t.long_in_view)},
          {"false_objects", t.false_objects},
          {"false_objects_per_lap", static_cast<double>(t.false_objects) / std::max(laps, 1)},
          {"position_error_m", t.position_error},
          {"speed_error_m_s", t.speed_error},
          {"yaw_error_rad", t.yaw_error},
          {"update_p99_ms", t.update_p99}};
}
/// Writes the figures of an evaluation's opponents.
Json overtaking_json(const OvertakingFigures& o) {
  const int decided = o.overtaken + o.not_overtaken;
  return {{"met", o.met},
          {"overtaken", o.overtaken},
          {"not_overtaken", o.not_overtaken},
          {"rate", decided > 0 ? Json(static_cast<double>(o.overtaken) / decided) : Json(nullptr)},
          {"rate_ci",
           interval_json(decided > 0 ? std::optional(wilson_interval(o.overtaken, decided)) : std::nullopt)},
          {"overtaking_time_s", o.overtaken > 0 ? Json(o.duration) : Json(nullptr)},
          {"contacts", o.contacts},
          {"contacts_caused", o.caused},
          {"side_changes", o.side_changes}};
}
}  // namespace

std::string course_hash(const Environment& environment) {
  std::uint64_t hash = 14695981039346656037ull;
  const auto mix = [&](const void* data, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i)
      // The analyser does not know that arrays of numbers have no undefined bytes.
      // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult)
      hash = (hash ^ static_cast<const unsigned char*>(data)[i]) * 1099511628211ull;
  };
  mix(environment.course.map.cells.data(), environment.course.map.cells.size());
  for (const auto& point : environment.path) {
    const double values[] = {point.x, point.y, point.yaw, point.speed};
    mix(values, sizeof values);
  }
  for (const auto& point : environment.course.obstacle_path) {
    const double values[] = {point.x, point.y};
    mix(values, sizeof values);
  }
  return formatted("%016llx", static_cast<unsigned long long>(hash));
}

void add_evaluation_options(Subcommand& command, EvaluationArguments& a) {
  add_world_options(command, a.scenario);
  command.option("--seed", a.seed0, "Seed of lap 0; lap k has SEED + k (obstacles + 5)");
  command.option("--jobs", a.jobs, "Number of laps driven in parallel; 0: one per processor core", {0, 1024});
  command.flag("--resume", a.resume, "Continue the evaluation in --out; finished laps are kept");
  command.flag("--any-build", a.any_build,
               "With --resume: continue even if another build of the program drove the earlier laps");
  command.json(a.json, "the summary");
  command.option("--out", a.out, "Output folder for laps.csv and summary.json");
}

std::vector<int> Evaluated::laps_begun_in_contact(int experiment) const {
  std::vector<int> laps;
  for (const LapRow& row : rows)
    if (row.experiment == experiment && began_in_contact(row, evaluation.environment->start))
      laps.push_back(row.lap);
  return laps;
}

Json Evaluated::summary() const {
  Json list = Json::array();
  for (const ExperimentResult& r : results) {
    const Experiment& e = evaluation.experiments[static_cast<std::size_t>(r.experiment)];
    Json result({{"method", e.method},
                 {"set", e.set_text()},
                 {"scenario", e.scenario},
                 {"obstacles", e.obstacles},
                 {"laps", r.laps},
                 {"finished", r.finished},
                 {"timeouts", r.timeouts},
                 {"contacts", r.collisions},
                 {"impassable", r.impassable},
                 {"began_in_contact", laps_begun_in_contact(r.experiment).size()},
                 {"ms_mean", r.ms_mean},
                 {"ms_ci", interval_json(r.laps >= fewest_laps ? std::optional(r.ms_ci) : std::nullopt)},
                 {"state_cost_mean", r.state_cost_mean},
                 {"collision_cost_mean", r.collision_cost_mean},
                 {"collision_rate", rate_json(r.collision_rate)},
                 {"collision_rate_ci", interval_json(r.collision_rate_ci)},
                 {"collision_rate_bootstrap_ci", interval_json(r.collision_rate_bootstrap_ci)},
                 {"success_rate", r.success_rate},
                 {"success_rate_ci", interval_json(r.success_rate_ci)},
                 {"lap_time_mean", r.lap_time_mean},
                 {"solve_ms",
                  {{"mean", r.solve_ms_mean},
                   {"p50", r.solve_ms_p50},
                   {"p99", r.solve_ms_p99},
                   {"max", r.solve_ms_max}}}});
    if (r.tracking) result["tracking"] = tracking_json(*r.tracking, r.laps);
    if (r.overtaking) result["overtaking"] = overtaking_json(*r.overtaking);
    list.push_back(std::move(result));
  }
  Json pairs = Json::array();
  for (const PairedComparison& c : compare_pairs(rows, evaluation.experiments)) {
    const Experiment &a = evaluation.experiments[static_cast<std::size_t>(c.a)],
                     &b = evaluation.experiments[static_cast<std::size_t>(c.b)];
    pairs.push_back({{"scenario", a.scenario},
                     {"a", a.label()},
                     {"b", b.label()},
                     {"laps", c.laps},
                     {"ms_difference", c.ms_difference},
                     {"ms_wilcoxon_p", c.ms_p},
                     {"only_a_succeeds", c.only_a_succeeds},
                     {"only_b_succeeds", c.only_b_succeeds},
                     {"success_mcnemar_p", c.success_p},
                     {"contacts_wilcoxon_p", c.collision_p}});
  }
  return {{"program", std::string("slalom ") + version()},
          {"build", build_id()},
          {"settings", parse_json(evaluation.settings)},
          {"machine", {{"cores", std::thread::hardware_concurrency()}, {"cpu", processor_name()}}},
          {"results", list},
          {"comparisons", pairs}};
}

Evaluation make_evaluation(const EvaluationArguments& arguments, const Scenario& scenario,
                           const std::vector<Experiment>& experiments) {
  return {.environment = scenario.environment,
          .configuration = scenario.configuration,
          .experiments = experiments,
          .seed0 = arguments.seed0,
          .latency = scenario.lap.latency,
          .hardware = arguments.scenario.hardware,
          .settings = json_text(settings_of(arguments, scenario, experiments), 2),
          .build = build_id(),
          .any_build = arguments.any_build};
}

bool run_evaluation(const EvaluationArguments& arguments, const std::vector<Experiment>& experiments,
                    Evaluated& evaluated) {
  if (experiments.empty()) throw CommandLineError("--methods", "must name at least one method");
  const Scenario scenario = load_scenario(arguments.scenario, experiments.front().method);
  print_notes(stderr, scenario);
  evaluated.evaluation = make_evaluation(arguments, scenario, experiments);
  // Do not create a folder for an evaluation that cannot be driven.
  for (const Experiment& e : experiments) {
    vehicle::Configuration trial = scenario.configuration;
    LapSettings world;
    for (const auto& [key, value] : e.set) apply_setting(key, value, e.method, trial, world);
  }
  for (int i = 0; i < static_cast<int>(experiments.size()); ++i)
    lap_setup(evaluated.evaluation, i).validate();
  LapStore store(arguments.out, evaluated.evaluation, arguments.resume);
  const InterruptFlag interrupt;
  bool is_whole = false;
  {
    ProgressLine progress(stderr);
    const auto show = [&](const EvaluationProgress& p) { progress.show(p); };
    const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    const int jobs = arguments.jobs > 0 ? arguments.jobs : cores;
    is_whole = drive_laps(evaluated.evaluation, store, jobs, show, interrupt.raised());
  }
  if (!is_whole) {
    std::fprintf(stderr, "interrupted after %zu laps; --resume continues\n", store.rows().size());
    return false;
  }
  evaluated.rows = store.rows();
  evaluated.results = summarise(evaluated.rows, evaluated.evaluation.experiments);
  return true;
}

void print_results(const Evaluated& evaluated, std::FILE* out) {
  std::size_t width = 6;
  for (const Experiment& e : evaluated.evaluation.experiments) width = std::max(width, e.label().size());
  std::fprintf(out, "%-*s  %-3s %5s %9s %19s %9s %17s %8s %9s\n", static_cast<int>(width), "method", "",
               "laps", "MS", "95 %", "collisions", "collision rate", "success", "solve p50");
  for (const ExperimentResult& r : evaluated.results) {
    const Experiment& e = evaluated.evaluation.experiments[static_cast<std::size_t>(r.experiment)];
    const std::string rate = r.collision_rate
                                 ? formatted("%.1f (%.1f-%.1f) %%", 100 * *r.collision_rate,
                                             100 * r.collision_rate_ci->low, 100 * r.collision_rate_ci->high)
                                 : "-";
    const std::string interval =
        r.laps >= fewest_laps ? formatted("%8.3f - %8.3f", r.ms_ci.low, r.ms_ci.high) : "-";
    std::fprintf(out, "%-*s  %-3s %5d %9.3f %19s %9d %17s %6.1f %% %9.3f\n", static_cast<int>(width),
                 e.label().c_str(), e.scenario.c_str(), r.laps, r.ms_mean, interval.c_str(), r.collisions,
                 rate.c_str(), 100 * r.success_rate, r.solve_ms_p50);
  }
  std::fprintf(
      out,
      "MS: mean cost of the control sequences sent in a lap, lower is better. Intervals: 95 %%, from %d "
      "laps on. Solve: median over a lap, ms.\n",
      fewest_laps);
  for (const ExperimentResult& r : evaluated.results) {
    if (!r.tracking) continue;
    const TrackingFigures& t = *r.tracking;
    const auto percent = [](int part, int whole) { return whole > 0 ? 100.0 * part / whole : 0.0; };
    std::fprintf(
        out,
        "%s: of cars in view within 8 m %.2f %% detected, after 0.2 s in view %.2f %%; %.2f false objects a "
        "lap; error %.3f m, %.2f m/s, %.3f rad (root mean square); update p99 %.2f ms\n",
        evaluated.evaluation.experiments[static_cast<std::size_t>(r.experiment)].label().c_str(),
        percent(t.detected, t.in_view), percent(t.long_detected, t.long_in_view),
        static_cast<double>(t.false_objects) / std::max(r.laps, 1), t.position_error, t.speed_error,
        t.yaw_error, t.update_p99);
  }
  for (const ExperimentResult& r : evaluated.results) {
    if (!r.overtaking) continue;
    const OvertakingFigures& o = *r.overtaking;
    std::fprintf(out,
                 "%s: opponents: %d met, %d overtaken (mean time %.1f s), %d not overtaken; %d contacts, %d "
                 "caused by the car; %d changes of side\n",
                 evaluated.evaluation.experiments[static_cast<std::size_t>(r.experiment)].label().c_str(),
                 o.met, o.overtaken, o.duration, o.not_overtaken, o.contacts, o.caused, o.side_changes);
  }
  // Laps of the same number have the same obstacles: those of the first experiment speak for all.
  std::string laps;
  int impassable = 0, experiment = -1;
  for (const LapRow& row : evaluated.rows) {
    if (row.impassable == 0 || (experiment >= 0 && row.experiment != experiment)) continue;
    experiment = row.experiment;
    impassable += row.impassable;
    laps += (laps.empty() ? "" : ", ") + std::to_string(row.lap);
  }
  if (impassable > 0)
    std::fprintf(out, "a car of this width cannot pass %d of the obstacles, in laps %s\n", impassable,
                 laps.c_str());
  std::string begun;
  if (!evaluated.results.empty())
    for (const int lap : evaluated.laps_begun_in_contact(evaluated.results.front().experiment))
      begun += (begun.empty() ? "" : ", ") + std::to_string(lap);
  if (!begun.empty())
    std::fprintf(out,
                 "an obstacle stands where the car starts, in laps %s; no driver avoids these collisions\n",
                 begun.c_str());
}

}  // namespace slalom::tools
