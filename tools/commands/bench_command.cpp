#include <cstdio>
#include <memory>
#include <stdexcept>
#include <thread>

#include "bench/workload/measurements.hpp"
#include "bench/workload/peak.hpp"
#include "src/evaluation/json.hpp"
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
  ScenarioArguments scenario;
  scenario.config = arguments.config.empty() ? "published" : arguments.config;
  scenario.set = arguments.set;
  vehicle::Configuration made = load_configuration(scenario, "svg_mppi");
  if (arguments.config.empty())
    made.vehicle.own_of<vehicle::published::ModelOptions>().straight_local_rollout = false;
  return made;
}

/// A vehicle model to compare, with the name that it has in the output.
struct ComparedModel {
  std::string name;
  vehicle::VehicleOptions options;
};

/// The vehicle models with the car and the body of the configuration `default`. The first one is the
/// reference.
std::vector<ComparedModel> compared_models() {
  ScenarioArguments scenario;
  scenario.config = "default";
  const vehicle::VehicleOptions sliding = load_configuration(scenario, "svg_mppi").vehicle;
  vehicle::VehicleOptions gripping;
  static_cast<vehicle::PathTrackingOptions&>(gripping) = sliding;
  std::vector<ComparedModel> made{{"kinematic", gripping},
                                  {"kinematic_acceleration", gripping},
                                  {"single_track, linear tyres", sliding},
                                  {"single_track, saturating tyres", sliding}};
  made[0].options.model = vehicle::vehicle_model("kinematic");
  made[1].options.model = vehicle::vehicle_model("kinematic_acceleration");
  made[2].options.own_of<vehicle::SingleTrackOptions>().tyres = vehicle::TyreModel::linear;
  made[3].options.own_of<vehicle::SingleTrackOptions>().tyres = vehicle::TyreModel::saturating;
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
  void rollouts() {
    workload::compare_with_yardstick(workload_, target_);
    const workload::RolloutSpeed speed =
        workload::measure_rollouts(workload_, configuration_.vehicle, 8000,
                                   workload::ReferenceWorkload::steps, target_, arguments_.seconds);
    json_["yardstick_ns_per_step"] = speed.yardstick.p50;
    json_["rollout_ns_per_step"] = speed.rollout.p50;
    json_["rollout_times_faster"] = speed.yardstick.p50 / speed.rollout.p50;
    std::fprintf(words_,
                 "yardstick %.1f ns a step, rollouts %.3f ns: %.1f times faster (minimum times: %.1f)",
                 speed.yardstick.p50, speed.rollout.p50, speed.yardstick.p50 / speed.rollout.p50,
                 speed.yardstick.min / speed.rollout.min);
    if (arguments_.config.empty()) operations(speed.rollout.p50);
    std::fprintf(words_, "\n");
  }

  /// The rate of the fixed workload, whose operations are known.
  void operations(double ns_per_step) {
    const double peak = workload::measured_peak_gflops(target_),
                 rate = workload::operations_per_step / ns_per_step;
    json_["rollout_gflops"] = rate;
    json_["peak_gflops"] = peak;
    json_["share_of_peak"] = rate / peak;
    std::fprintf(words_, "; %.0f GFLOP/s, %.0f %% of this core's %.0f", rate, 100 * rate / peak, peak);
  }

  /// Rollouts of each vehicle model over plans as long as those of the configuration `default`, alternately.
  void vehicle_models() {
    constexpr int samples = 2000, steps = 20;
    const std::vector<ComparedModel> compared = compared_models();
    std::vector<vehicle::VehicleOptions> options;
    for (const ComparedModel& each : compared) options.push_back(each.options);
    const auto times =
        workload::measure_alternately(workload_, options, samples, steps, target_, arguments_.seconds);
    std::fprintf(words_, "vehicle models, measured alternately, ns a step (times the first):");
    for (std::size_t i = 0; i < times.size(); ++i) {
      const double ratio = times[i].p50 / times.front().p50;
      json_["vehicle_models"].push_back(
          {{"model", compared[i].name}, {"rollout_ns_per_step", times[i].p50}, {"times_the_first", ratio}});
      std::fprintf(words_, "%s %s %.3f (%.2f)", i > 0 ? ";" : "", compared[i].name.c_str(), times[i].p50,
                   ratio);
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

  workload::SolveSpeed solve(const char* name, int samples, int threads, int horizon = 0) {
    for (const SolverOptions& options : configuration_.methods) {
      if (std::string(solver_name(options)) == name)
        return workload::measure_solve(workload_, configuration_.vehicle,
                                       with(options, samples, threads, horizon), 0.1 * arguments_.seconds);
    }
    throw std::invalid_argument(std::string("no method ") + name);
  }

  void scaling() {
    Json& json = json_["scaling"];
    for (const char* name : {"mppi", "svg_mppi"}) {
      for (int log2 = 7; log2 <= 17; ++log2) {
        const workload::SolveSpeed s = solve(name, 1 << log2, 1);
        json["samples"][name].push_back({{"samples", 1 << log2}, {"solve_ms", s.solve.p50}});
        std::fprintf(words_, "%-9s K %6d  %9.3f ms\n", name, 1 << log2, s.solve.p50);
      }
    }
    for (int horizon = 7; horizon <= 112; horizon *= 2) {
      const workload::SolveSpeed s = solve("svg_mppi", 0, 1, horizon);
      json["horizon"].push_back({{"steps", horizon}, {"solve_ms", s.solve.p50}});
      std::fprintf(words_, "svg_mppi  T %6d  %9.3f ms\n", horizon, s.solve.p50);
    }
    const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    for (int threads = 1; threads <= cores; threads *= 2) {
      const workload::SolveSpeed s = solve("svg_mppi", 0, threads);
      json["threads"].push_back({{"threads", threads}, {"solve_ms", s.solve.p50}});
      std::fprintf(words_, "svg_mppi  threads %d  %6.3f ms\n", threads, s.solve.p50);
    }
    for (const simd::Target target :
         {simd::Target::generic, simd::Target::sse4, simd::Target::avx2, simd::Target::avx512}) {
      if (!simd::supported(target)) continue;
      const workload::RolloutSpeed s =
          workload::measure_rollouts(workload_, configuration_.vehicle, 8000,
                                     workload::ReferenceWorkload::steps, target, 0.2 * arguments_.seconds);
      json["targets"].push_back({{"target", simd::name(target)},
                                 {"rollout_ns_per_step", s.rollout.p50},
                                 {"yardstick_ns_per_step", s.yardstick.p50}});
      std::fprintf(words_, "rollouts  %-8s %6.3f ns a step, %.1f times the yardstick\n", simd::name(target),
                   s.rollout.p50, s.yardstick.p50 / s.rollout.p50);
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
  command.option("--set", arguments->set, "section.option=value; may be repeated").repeatable();
  command.option("--methods", arguments->methods, "Methods to measure, separated by commas [all]")
      .comma_separated();
  command.option("--seconds", arguments->seconds, "Duration of each measurement, s", {0.01, 600.0});
  command.flag("--scaling", arguments->scaling,
               "Also measure over samples, horizon, threads and instruction sets");
  command.json(arguments->json, "the figures");
  command.footer("SLALOM_TARGET=avx2 (avx512, sse4, generic) forces an instruction set.");
  command.action([arguments] { return Bench(*arguments).run(); });
}

}  // namespace slalom::tools
