// The experiments of an evaluation, from --methods, --scenario and --set.
#include "tools/evaluation/evaluation_job.hpp"

#include <set>
#include <thread>

#include "json/json.hpp"
#include "slalom/core/instruction_set.hpp"
#include "slalom/core/version.hpp"
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
  add_conditions(settings, arguments.scenario, scenario);
  return settings;
}

using evaluation::Experiment;

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts(1);
  int depth = 0;
  for (const char c : text) {
    depth += (c == '[') - (c == ']');
    if (c == at && depth == 0) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

struct Sweep {
  std::string key;
  std::vector<std::string> values;
};

Sweep parse_sweep(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw CommandLineError("--set", text, "must be key=value or key=v1,v2,...");
  Sweep sweep{text.substr(0, equals), split(text.substr(equals + 1), ',')};
  for (const auto& value : sweep.values) {
    if (value.empty()) throw CommandLineError("--set", text, "must have a value behind each comma");
  }
  return sweep;
}

/// Whether an option affects laps of a method: an option of the method, vehicle, planner or world.
bool applies_to(const std::string& key, const std::string& method) {
  const auto dot = key.find('.');
  if (dot == std::string::npos) return true;
  const std::string section = key.substr(0, dot);
  return section == method || section == "vehicle" || section == "planner" || section == "world";
}

/// Throws CommandLineError if an option affects none of the methods.
void require_driven(const std::string& key, const std::vector<std::string>& methods) {
  std::string names;
  for (const std::string& method : methods) {
    if (applies_to(key, method)) return;
    names += (names.empty() ? "" : ", ") + method;
  }
  throw CommandLineError("--set", key, "must be an option of a method in this evaluation (" + names + ")");
}

/// Throws CommandLineError if both keys are the same option of one of the methods.
void refuse_twice(const std::string& key, const std::string& other, const std::vector<std::string>& methods) {
  const auto full = [](const std::string& name, const std::string& method) {
    return name.find('.') == std::string::npos ? method + "." + name : name;
  };
  for (const std::string& method : methods)
    if (full(key, method) == full(other, method))
      throw CommandLineError("--set", key,
                             "is given twice; separate several values by commas: " + key + "=v1,v2,...");
}

/// Parses the sweeps. Each must affect one of the methods, and no two the same option.
std::vector<Sweep> parse_sweeps(const std::vector<std::string>& texts,
                                const std::vector<std::string>& methods) {
  std::vector<Sweep> sweeps;
  for (const std::string& text : texts) {
    Sweep sweep = parse_sweep(text);
    require_driven(sweep.key, methods);
    for (const Sweep& other : sweeps) refuse_twice(sweep.key, other.key, methods);
    sweeps.push_back(std::move(sweep));
  }
  return sweeps;
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
  if (arguments.prepare) return false;
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

std::vector<Experiment> make_experiments(const std::vector<std::string>& methods,
                                         const std::vector<std::string>& scenarios, int laps, int obstacles,
                                         const std::vector<std::string>& texts) {
  std::vector<Experiment> experiments;
  for (const std::string& method : methods) for_option("--methods", [&] { return solver_options(method); });
  const std::vector<Sweep> sweeps = parse_sweeps(texts, methods);
  for (const std::string& scenario : scenarios) {
    if (scenario != "pt" && scenario != "oa")
      throw CommandLineError("--scenario", scenario, "must be pt or oa");
    for (const std::string& method : methods) {
      std::vector<Experiment> variants{{method, {}, scenario, scenario == "pt" ? 0 : obstacles, laps}};
      for (const Sweep& sweep : sweeps) {
        if (!applies_to(sweep.key, method)) continue;
        std::vector<Experiment> next;
        for (const Experiment& variant : variants) {
          for (const std::string& value : sweep.values) {
            next.push_back(variant);
            next.back().set.emplace_back(sweep.key, value);
          }
        }
        variants = std::move(next);
      }
      experiments.insert(experiments.end(), variants.begin(), variants.end());
    }
  }
  // Two equal experiments could not be distinguished in laps.csv.
  std::set<std::string> seen;
  for (const Experiment& e : experiments)
    if (!seen.insert(e.label() + ", " + e.scenario).second)
      throw CommandLineError("--methods, --scenario, --set",
                             "specify the experiment '" + e.label() + ", " + e.scenario + "' twice");
  return experiments;
}

}  // namespace slalom::tools
