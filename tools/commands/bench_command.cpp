#include <thread>

#include "bench/workload/measurements.hpp"
#include "json/json.hpp"
#include "tools/commands/commands.hpp"
#include "tools/evaluation/build_id.hpp"
#include "tools/scenario/scenario.hpp"
#include "tools/terminal/json_output.hpp"

namespace slalom::tools {
namespace {

struct BenchArguments {
  std::string config, json;
  std::vector<std::string> set, methods;
  double seconds = 0.5;
  bool scaling = false;
};

/// The given configuration. Without one, the workload `reference`: the configuration `published` with one
/// trajectory per rollout.
vehicle::Configuration configuration_of(const BenchArguments& arguments) {
  ScenarioArguments scenario{.config = arguments.config.empty() ? "published" : arguments.config,
                             .set = arguments.set};
  vehicle::Configuration made = load_configuration(scenario, "svg_mppi");
  if (arguments.config.empty())
    made.vehicle.own_of<vehicle::published::ModelOptions>().straight_local_rollout = false;
  return made;
}

constexpr const char* compared_models[] = {"kinematic", "kinematic_acceleration",
                                           "single_track, linear tyres", "single_track, saturating tyres"};

/// The vehicle models of compared_models with the car and the body of the configuration `default`.
std::vector<vehicle::VehicleOptions> models_to_compare() {
  ScenarioArguments scenario{.config = "default"};
  const vehicle::VehicleOptions sliding = load_configuration(scenario, "svg_mppi").vehicle;
  vehicle::VehicleOptions gripping;
  static_cast<vehicle::PathTrackingOptions&>(gripping) = sliding;
  std::vector<vehicle::VehicleOptions> made{gripping, gripping, sliding, sliding};
  made[0].model = vehicle::vehicle_model("kinematic");
  made[1].model = vehicle::vehicle_model("kinematic_acceleration");
  made[2].own_of<vehicle::SingleTrackOptions>().tyres = vehicle::TyreModel::linear;
  made[3].own_of<vehicle::SingleTrackOptions>().tyres = vehicle::TyreModel::saturating;
  return made;
}

Json json_of(const workload::TimeStatistics& t) {
  return {{"p50", t.p50}, {"p99", t.p99}, {"max", t.max}, {"min", t.min}};
}

/// Changes the sample count of any method's options.
SolverOptions with(SolverOptions options, int samples, int threads, int horizon = 0) {
  int* const count = options.find<int>("samples");
  if (count && samples > 0) *count = samples;
  *options.find<int>("threads") = threads;
  if (horizon > 0) *options.find<int>("horizon") = horizon;
  return options;
}

class Bench {
 public:
  explicit Bench(const BenchArguments& arguments)
      : arguments_(arguments),
        words_(arguments.json == "-" ? stderr : stdout),
        configuration_(configuration_of(arguments)),
        target_(simd::active_target()) {
    for (const std::string& method : arguments.methods)
      for_option("--methods", [&] { return solver_options(method); });
  }

  int run() {
    json_["target"] = simd::name(target_);
    json_["cpu"] = processor_name();
    json_["compiler"] = __VERSION__;
    json_["config"] = arguments_.config.empty() ? "reference" : arguments_.config;
    std::fprintf(words_, "%s, %s, %s; workload %s\n", processor_name().c_str(), simd::name(target_),
                 __VERSION__, json_["config"].get<std::string>().c_str());
    rollouts();
    vehicle_models();
    std::fprintf(words_, "%-14s %8s %8s %8s %10s %9s | %s\n", "ms", "p50", "p99", "max", "yardstick",
                 "prepared", "draw, evaluate, guide, update (us)");
    for (const SolverOptions& options : configuration_.methods) {
      const std::string name = solver_name(options);
      const auto& wanted = arguments_.methods;
      if (wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end()) method(options);
    }
    tick();
    if (arguments_.scaling) scaling();
    if (!arguments_.json.empty()) write_json(json_, arguments_.json);
    return 0;
  }

 private:
  /// The speed of 8000 rollouts of the configuration.
  std::pair<workload::TimeStatistics, workload::TimeStatistics> measured(simd::Target target,
                                                                         double seconds) {
    const auto speed = workload::measure_rollouts(workload_, {&configuration_.vehicle, 1}, 8000,
                                                  workload::ReferenceWorkload::steps, target, seconds);
    return {speed.yardstick, speed.rollouts.front()};
  }

  void rollouts() {
    workload::compare_with_yardstick(workload_, target_);
    const auto [yardstick, rollout] = measured(target_, arguments_.seconds);
    json_["yardstick_ns_per_step"] = yardstick.p50;
    json_["rollout_ns_per_step"] = rollout.p50;
    json_["rollout_times_faster"] = yardstick.p50 / rollout.p50;
    std::fprintf(words_,
                 "yardstick %.1f ns a step, rollouts %.3f ns: %.1f times faster (minimum times: %.1f)\n",
                 yardstick.p50, rollout.p50, yardstick.p50 / rollout.p50, yardstick.min / rollout.min);
  }

  /// Measures rollouts of each vehicle model over plans as long as of `default`, alternately.
  void vehicle_models() {
    const auto times =
        workload::measure_rollouts(workload_, models_to_compare(), 2000, 20, target_, arguments_.seconds)
            .rollouts;
    std::fprintf(words_, "vehicle models, measured alternately, ns a step (times the first):");
    for (std::size_t i = 0; i < times.size(); ++i) {
      const double ratio = times[i].p50 / times.front().p50;
      json_["vehicle_models"].push_back(
          {{"model", compared_models[i]}, {"rollout_ns_per_step", times[i].p50}, {"times_the_first", ratio}});
      std::fprintf(words_, "%s %s %.3f (%.2f)", i > 0 ? ";" : "", compared_models[i], times[i].p50, ratio);
    }
    std::fprintf(words_, "\n");
  }

  void method(const SolverOptions& options) {
    const workload::SolveSpeed s =
        workload::measure_solve(workload_, configuration_.vehicle, with(options, 0, 1), arguments_.seconds);
    Json& json = json_["methods"][s.method];
    json["solve_ms"] = json_of(s.solve);
    json["solve_yardstick_steps"] = s.solve.p50 * 1e6 / s.yardstick.p50;
    json["prepared_ms"] = json_of(s.prepared);
    json["yardstick_ns_per_step"] = s.yardstick.p50;
    json["degenerate_share"] = s.degenerate_share;
    json["stage_ms"] = {{"draw", 1e3 * s.stages.draw},
                        {"evaluate", 1e3 * s.stages.evaluate},
                        {"guide", 1e3 * s.stages.guide},
                        {"update", 1e3 * s.stages.update}};
    std::fprintf(words_, "%-14s %8.3f %8.3f %8.3f %7.1f ns %9.3f | %.0f, %.0f, %.0f, %.0f\n",
                 s.method.c_str(), s.solve.p50, s.solve.p99, s.solve.max, s.yardstick.p50, s.prepared.p50,
                 1e6 * s.stages.draw, 1e6 * s.stages.evaluate, 1e6 * s.stages.guide, 1e6 * s.stages.update);
  }

  void tick() {
    const workload::TickSpeed speed = workload::measure_tick(configuration_, arguments_.seconds);
    json_["tick_ms"] = speed.tick.p50;
    json_["tick"] = {{"whole_ms", json_of(speed.tick)}, {"without_solve_ms", json_of(speed.round_solver)}};
    std::fprintf(words_, "planner update %.3f ms (p99 %.3f), without the solve %.3f ms\n", speed.tick.p50,
                 speed.tick.p99, speed.round_solver.p50);
  }

  /// The median time of a solve of one of the configuration's methods, ms.
  double solve_time(const std::string& name, int samples, int threads, int horizon = 0) {
    for (const SolverOptions& options : configuration_.methods)
      if (solver_name(options) == name)
        return workload::measure_solve(workload_, configuration_.vehicle,
                                       with(options, samples, threads, horizon), 0.1 * arguments_.seconds)
            .solve.p50;
    throw std::invalid_argument("no method " + name);
  }

  void scaling() {
    Json& json = json_["scaling"];
    const auto tell = [&](Json& list, const char* method, const char* of, int value, double time) {
      list.push_back({{of, value}, {"solve_ms", time}});
      std::fprintf(words_, "%-9s %-8s %6d  %9.3f ms\n", method, of, value, time);
    };
    for (const char* name : {"mppi", "svg_mppi"})
      for (int samples = 128; samples <= 131072; samples *= 2)
        tell(json["samples"][name], name, "samples", samples, solve_time(name, samples, 1));
    for (int steps = 7; steps <= 112; steps *= 2)
      tell(json["horizon"], "svg_mppi", "steps", steps, solve_time("svg_mppi", 0, 1, steps));
    const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    for (int threads = 1; threads <= cores; threads *= 2)
      tell(json["threads"], "svg_mppi", "threads", threads, solve_time("svg_mppi", 0, threads));
    for (const simd::Target target :
         {simd::Target::generic, simd::Target::sse4, simd::Target::avx2, simd::Target::avx512}) {
      if (!simd::supported(target)) continue;
      const auto [yardstick, rollout] = measured(target, 0.2 * arguments_.seconds);
      json["targets"].push_back({{"target", simd::name(target)},
                                 {"rollout_ns_per_step", rollout.p50},
                                 {"yardstick_ns_per_step", yardstick.p50}});
      std::fprintf(words_, "rollouts  %-8s %6.3f ns a step, %.1f times the yardstick\n", simd::name(target),
                   rollout.p50, yardstick.p50 / rollout.p50);
    }
  }

  const BenchArguments& arguments_;
  std::FILE* words_;
  vehicle::Configuration configuration_;
  simd::Target target_;
  workload::ReferenceWorkload workload_;
  Json json_;
};

}  // namespace

void declare_bench(Subcommand& command) {
  command.summary(
      "Measure the speed of rollouts, methods and planner on this machine, relative to scalar code");
  const auto arguments = std::make_shared<BenchArguments>();
  command.option("--config", arguments->config,
                 "Configuration to measure [fixed workload: the methods and the vehicle problem of the "
                 "configuration published, with one trajectory per rollout]");
  command.option("--set", arguments->set, "section.option=value; may be repeated");
  command.option("--methods", arguments->methods, "Methods to measure, separated by commas [all]",
                 {.comma_separated = true});
  command.option("--seconds", arguments->seconds, "Duration of each measurement, s", {0.01, 600.0});
  command.flag("--scaling", arguments->scaling,
               "Also measure over samples, horizon, threads and instruction sets");
  command.json(arguments->json, "the figures");
  command.examples({"bench", "bench --config race --methods svg_mppi,mppi --seconds 1"},
                   "SLALOM_TARGET=avx2 (avx512, sse4, generic) forces an instruction set.");
  command.action([arguments] { return Bench(*arguments).run(); });
}

}  // namespace slalom::tools
