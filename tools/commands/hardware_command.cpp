#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <mutex>

#include "slalom/core/error.hpp"
#include "slalom/evaluation/statistics.hpp"
#include "slalom/evaluation/worker_threads.hpp"
#include "src/evaluation/json.hpp"
#include "tools/commands/commands.hpp"
#include "tools/report/lap_json.hpp"
#include "tools/scenario/scenario.hpp"
#include "tools/terminal/interrupt.hpp"
#include "tools/terminal/json_output.hpp"
#include "tools/terminal/thread_note.hpp"

namespace slalom::tools {
namespace {

using namespace evaluation;

struct HardwareArguments {
  std::string course = "wren", json;
  std::vector<std::string> drivers{"mppi@hardware", "svg_mppi@hardware", "svg_mppi@default"}, set;
  int tracking_laps = 10, layouts = 6, laps = 3, obstacles = 5, jobs = 1;
  double latency_ms = 10;
};

/// A lap to be driven, and how it was.
struct Task {
  std::size_t driver = 0;
  int layout = -1;  ///< -1: path tracking
  std::uint64_t seed = 0;
  LapResult result;
  bool done = false;
};

struct Driver {
  std::string label, method;
  vehicle::Configuration configuration;
};

Driver make_driver(const std::string& text, const HardwareArguments& arguments) {
  const auto at = text.find('@');
  Driver driver{text, text.substr(0, at), {}};
  ScenarioArguments scenario;
  scenario.config = at == std::string::npos ? "hardware" : text.substr(at + 1);
  scenario.set = arguments.set;
  driver.configuration = load_configuration(scenario, driver.method);
  // Every driver's planner knows the latency, since it can be measured without driving.
  driver.configuration.planner.latency = 1e-3 * arguments.latency_ms;
  return driver;
}

/// All laps, in parallel; the results do not depend on the number of threads. False if interrupted.
bool drive(std::vector<Task>& tasks, const std::vector<Driver>& drivers,
           const std::shared_ptr<const Environment>& environment, const HardwareArguments& arguments) {
  std::mutex mutex;
  std::size_t next = 0;
  std::exception_ptr failed;
  const InterruptFlag interrupt;
  const auto work = [&] {
    for (;;) {
      Task* task = nullptr;
      {
        const std::lock_guard lock(mutex);
        if (next == tasks.size() || failed || interrupt.raised()) return;
        task = &tasks[next++];
        std::fprintf(stderr, "lap %zu of %zu: %s\n", next, tasks.size(), drivers[task->driver].label.c_str());
      }
      try {
        const Driver& driver = drivers[task->driver];
        LapSettings settings;
        settings.latency = 1e-3 * arguments.latency_ms;
        settings.hardware = HardwareConditions{};
        settings.obstacles = task->layout < 0 ? 0 : arguments.obstacles;
        if (task->layout >= 0) settings.layout = static_cast<std::uint64_t>(1000 + task->layout);
        task->result = run_lap({environment, {driver.configuration, driver.method}, settings}, task->seed, {},
                               &interrupt.raised());
        task->done = !task->result.cancelled;
      } catch (...) {
        const std::lock_guard lock(mutex);
        failed = std::current_exception();
      }
    }
  };
  note_fewer_threads("--jobs", arguments.jobs, run_in_threads(arguments.jobs, work));
  if (failed) std::rethrow_exception(failed);
  return !interrupt.raised();
}

double percentile_of(std::vector<float> values, double share) {
  std::sort(values.begin(), values.end());
  return evaluation::percentile(values, share);
}
double mean_of(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += static_cast<double>(v);
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(values.size());
}

/// The laps of one driver in one scenario.
Json summarise(const std::vector<Task>& tasks, std::size_t driver, bool among_obstacles,
               const HardwareArguments& arguments) {
  std::vector<double> costs;
  std::vector<float> errors, yaw_errors, update_ms, solve_ms;
  EstimationRecord states;  // empty for models whose tyres do not slip
  int laps = 0, finished = 0, contacts = 0, with_collision = 0, blind = 0, steps = 0;
  double time = 0;
  for (const Task& task : tasks) {
    if (!task.done || task.driver != driver || (task.layout >= 0) != among_obstacles) continue;
    const LapResult& r = task.result;
    ++laps;
    finished += r.finished;
    contacts += r.collisions;
    with_collision += r.collisions > 0;
    blind += r.localisation.blind;
    steps += r.steps;
    costs.push_back(r.mean_sequence_cost);
    if (r.finished) time += r.time;
    const auto append = [](std::vector<float>& all, const std::vector<float>& more) {
      all.insert(all.end(), more.begin(), more.end());
    };
    append(errors, r.localisation.error);
    append(yaw_errors, r.localisation.yaw_error);
    append(update_ms, r.localisation.update_ms);
    append(solve_ms, r.solve_ms);
    append(states.yaw_rate_error, r.estimation.yaw_rate_error);
    append(states.slip_error, r.estimation.slip_error);
    append(states.speed_error, r.estimation.speed_error);
  }
  const Interval ms = bootstrap_mean(costs);
  Json row{
      {"laps", laps},
      {"finished", finished},
      {"ms_mean", mean(costs)},
      {"ms_ci", {ms.low, ms.high}},
      {"contacts", contacts},
      {"laps_with_contact", with_collision},
      {"lap_time_mean", finished > 0 ? Json(time / finished) : Json(nullptr)},
      {"blind_steps_share", steps > 0 ? static_cast<double>(blind) / steps : 0},
      {"localisation_error_m", {{"mean", mean_of(errors)}, {"p99", percentile_of(errors, 0.99)}}},
      {"localisation_error_rad", {{"mean", mean_of(yaw_errors)}, {"p99", percentile_of(yaw_errors, 0.99)}}},
      {"localisation_ms", {{"p50", percentile_of(update_ms, 0.5)}, {"p99", percentile_of(update_ms, 0.99)}}},
      {"solve_ms", {{"p50", percentile_of(solve_ms, 0.5)}, {"p99", percentile_of(solve_ms, 0.99)}}}};
  if (!states.slip_error.empty()) {
    row["estimation"] = {{"yaw_rate_rms", root_mean_square(states.yaw_rate_error)},
                         {"slip_rms", root_mean_square(states.slip_error)},
                         {"speed_rms", root_mean_square(states.speed_error)}};
  }
  if (among_obstacles) {
    const int chances = laps * arguments.obstacles;
    const Interval rate = wilson_interval(contacts, chances);
    row["collision_rate"] = static_cast<double>(contacts) / std::max(1, chances);
    row["collision_rate_ci"] = {rate.low, rate.high};
  }
  return row;
}

void print_row(std::FILE* out, const std::string& label, const char* scenario, const Json& r) {
  char rate[40] = "-";
  if (r.contains("collision_rate"))
    std::snprintf(rate, sizeof rate, "%.1f (%.1f-%.1f) %%", 100 * r["collision_rate"].get<double>(),
                  100 * r["collision_rate_ci"][0].get<double>(),
                  100 * r["collision_rate_ci"][1].get<double>());
  std::fprintf(out, "%-20s %-3s %3d/%-3d %8.3f %8.3f -%8.3f %8d %18s %10.3f %6.3f %8.2f %6.2f\n",
               label.c_str(), scenario, r["finished"].get<int>(), r["laps"].get<int>(),
               r["ms_mean"].get<double>(), r["ms_ci"][0].get<double>(), r["ms_ci"][1].get<double>(),
               r["contacts"].get<int>(), rate, r["localisation_error_m"]["mean"].get<double>(),
               r["localisation_error_m"]["p99"].get<double>(), r["localisation_ms"]["p50"].get<double>(),
               r["localisation_ms"]["p99"].get<double>());
  if (!r.contains("estimation")) return;
  const Json& errors = r["estimation"];
  std::fprintf(out,
               "  error of yaw rate %.3f rad/s, slip %.4f rad, speed %.3f m/s (root mean square of all "
               "control steps)\n",
               errors["yaw_rate_rms"].get<double>(), errors["slip_rms"].get<double>(),
               errors["speed_rms"].get<double>());
}

int hardware(const HardwareArguments& arguments) {
  if (arguments.tracking_laps == 0 && arguments.layouts == 0)
    throw IoError("--tracking-laps, --layouts", 0, "one of them must be greater than 0");
  std::vector<Driver> drivers;
  for (const std::string& text : arguments.drivers) {
    if (std::count(arguments.drivers.begin(), arguments.drivers.end(), text) > 1)
      throw IoError("--drivers", 0, "'" + text + "' is given twice");
    drivers.push_back(make_driver(text, arguments));
  }
  const auto roots = vehicle::course_roots(program_folder());
  const auto environment =
      load_environment(vehicle::find_course(arguments.course, roots), Protocol::true_physics, roots);
  std::vector<Task> tasks;
  for (std::size_t d = 0; d < drivers.size(); ++d) {
    for (int lap = 0; lap < arguments.tracking_laps; ++lap)
      tasks.push_back({d, -1, static_cast<std::uint64_t>(lap + 1), {}, false});
    for (int layout = 0; layout < arguments.layouts; ++layout)
      for (int lap = 0; lap < arguments.laps; ++lap)
        tasks.push_back({d, layout, static_cast<std::uint64_t>(100 + 10 * layout + lap), {}, false});
  }
  const bool whole = drive(tasks, drivers, environment, arguments);
  if (!whole)
    std::fprintf(stderr, "interrupted after %td of %zu laps\n",
                 std::count_if(tasks.begin(), tasks.end(), [](const Task& task) { return task.done; }),
                 tasks.size());
  std::FILE* words = arguments.json == "-" ? stderr : stdout;
  std::fprintf(words, "%-20s %-3s %7s %8s %18s %8s %18s %17s %15s\n", "driver", "", "done", "MS", "95 %",
               "collisions", "collision rate", "pose m, mean p99", "ms, p50 p99");
  Json rows = Json::array();
  for (std::size_t d = 0; d < drivers.size(); ++d) {
    for (const bool among : {false, true}) {
      const bool any = std::any_of(tasks.begin(), tasks.end(), [&](const Task& task) {
        return task.done && task.driver == d && (task.layout >= 0) == among;
      });
      if (!any) continue;
      Json row = summarise(tasks, d, among, arguments);
      print_row(words, drivers[d].label, among ? "oa" : "pt", row);
      Json named{{"driver", drivers[d].label}, {"scenario", among ? "oa" : "pt"}};
      named.update(row);
      rows.push_back(named);
    }
  }
  if (arguments.json.empty()) return whole ? 0 : 1;
  Json conditions;
  for (const OptionEntry& entry : list_options(HardwareConditions{}))
    conditions[entry.declaration.name] = to_text(entry.value);
  Json told{{"course", arguments.course},
            {"latency_ms", arguments.latency_ms},
            {"obstacles", arguments.obstacles},
            {"conditions", conditions},
            {"results", rows}};
  if (!whole) told["interrupted"] = true;
  write_json(told, arguments.json);
  return whole ? 0 : 1;
}

}  // namespace

void declare_hardware(Subcommand& command) {
  command.summary(
      "Evaluate laps under the conditions of a real car: noise, slip, localisation, servo mismatch");
  const auto arguments = std::make_shared<HardwareArguments>();
  command.option("--course", arguments->course, "Course name or folder").show_default();
  command.option("--drivers", arguments->drivers, "Drivers, method@configuration, separated by commas")
      .comma_separated()
      .show_default();
  command.option("--set", arguments->set, "section.option=value, for all drivers; may be repeated")
      .repeatable();
  command.option("--tracking-laps", arguments->tracking_laps, "Number of laps without obstacles")
      .range(0, 100000)
      .show_default();
  command.option("--layouts", arguments->layouts, "Number of obstacle layouts, the same for all drivers")
      .range(0, 10000)
      .show_default();
  command.option("--laps", arguments->laps, "Number of laps in each layout").range(1, 10000).show_default();
  command.option("--obstacles", arguments->obstacles, "Number of parked cars in a layout")
      .range(1, 1000)
      .show_default();
  command
      .option("--latency-ms", arguments->latency_ms,
              "Delay from a scan to the effect of its command on the servo, ms")
      .range(0.0, 500.0)
      .show_default();
  command.option("--jobs", arguments->jobs, "Number of laps driven in parallel")
      .range(1, 1024)
      .show_default();
  command.option("--json", arguments->json, "Write the results to this file, or to standard output: -");
  command.action([arguments] { return hardware(*arguments); });
}

}  // namespace slalom::tools
