#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "slalom/core/error.hpp"
#include "slalom/evaluation/statistics.hpp"
#include "src/evaluation/json.hpp"
#include "tools/commands/commands.hpp"
#include "tools/drawing/course_pictures.hpp"
#include "tools/recording/recording.hpp"
#include "tools/scenario/lap_json.hpp"
#include "tools/scenario/scenario.hpp"
#include "tools/terminal/interrupt.hpp"
#include "tools/terminal/json_output.hpp"
#include "tools/terminal/progress.hpp"

namespace slalom::tools {
namespace {

using evaluation::LapResult;

struct DriveArguments {
  ScenarioArguments scenario;
  std::string method = "svg_mppi";
  std::uint64_t seed = 0;
  int laps = 1;
  std::string json, record, plot;
  bool record_all = false, record_times = false;
};

/// The longest time that a car stood in a lap.
class LongestStand {
 public:
  void add(const evaluation::ControlStep& step) {
    if (std::abs(step.seen.speed) > moving ||
        std::hypot(step.seen.pose.x - at_.x, step.seen.pose.y - at_.y) > near) {
      at_ = step.seen.pose;
      since_ = step.time;
      blocked_ = steps_ = 0;
    }
    ++steps_;
    blocked_ += step.output.status == vehicle::PlannerStatus::blocked;
    if (step.time - since_ <= duration) return;
    duration = step.time - since_;
    place = at_;
    progress = step.progress;
    every_plan_collides = 2 * blocked_ > steps_;
  }

  double duration = 0;               ///< s
  maps::Pose place;                  ///< pose of the centre of gravity
  double progress = 0;               ///< share of the lap
  bool every_plan_collides = false;  ///< or it reversed, most of the time

 private:
  static constexpr double moving = 1.0, near = 1.0;  // m/s, m
  maps::Pose at_;
  double since_ = 0;
  int blocked_ = 0, steps_ = 0;
};

/// A drive of several laps and its outputs.
class DriveJob {
 public:
  explicit DriveJob(const DriveArguments& arguments)
      : arguments_(arguments),
        words_(arguments.json == "-" ? stderr : stdout),
        scenario_(load_scenario(arguments.scenario, arguments.method)),
        setup_{scenario_.environment, {scenario_.configuration, arguments.method}, scenario_.lap},
        settings_(settings_json(arguments.scenario, scenario_, arguments.method)) {
    setup_.validate();
    settings_["seed"] = arguments.seed;
    settings_["laps"] = arguments.laps;
    settings_["timeout_s"] = setup_.timeout();
    settings_["control_period_s"] = setup_.control_period();
    if (!arguments.record.empty())
      recording_.emplace(arguments.record, RecordingFacts{.arguments = arguments.scenario,
                                                          .scenario = scenario_,
                                                          .method = arguments.method,
                                                          .seed = arguments.seed,
                                                          .control_period = setup_.control_period(),
                                                          .settings = settings_,
                                                          .everything = arguments.record_all,
                                                          .times = arguments.record_times});
  }

  /// The exit status.
  int run() {
    print_notes(words_, scenario_);
    std::fprintf(words_, "%s on %s, configuration %s, evaluation %s, %d obstacle%s, seed %llu\n",
                 arguments_.method.c_str(), scenario_.environment->course.name.c_str(),
                 arguments_.scenario.config.c_str(), arguments_.scenario.evaluation.c_str(),
                 scenario_.lap.obstacles, scenario_.lap.obstacles == 1 ? "" : "s",
                 static_cast<unsigned long long>(arguments_.seed));
    try {
      const InterruptFlag interrupt;
      for (int lap = 0; lap < arguments_.laps && !interrupt.raised(); ++lap) drive(lap, interrupt.raised());
    } catch (...) {
      if (!laps_.empty()) write_results();
      throw;
    }
    if (!laps_.empty()) write_results();
    return finished() == arguments_.laps ? 0 : 1;
  }

 private:
  void drive(int lap, const std::atomic<bool>& interrupted) {
    const std::uint64_t seed = evaluation::lap_seed(arguments_.seed, lap, scenario_.lap.obstacles);
    if (recording_) recording_->begin_lap(seed);
    driven_ = {};
    LongestStand stand;
    LapResult result;
    {
      ProgressLine progress(words_);
      const auto on_step = [&](const evaluation::ControlStep& tick) {
        progress.show(lap + 1, arguments_.laps, tick);
        stand.add(tick);
        if (recording_) recording_->add(tick);
        if (arguments_.plot.empty()) return;
        driven_.points.push_back({tick.seen.pose.x, tick.seen.pose.y});
        driven_.speeds.push_back(tick.seen.speed);
      };
      result = run_lap(setup_, seed, on_step, &interrupted);
    }
    if (result.steps == 0) return;
    laps_.push_back(std::move(result));
    say(laps_.back());
    if (laps_.back().timeout) say_stand(stand);
    if (recording_) recording_->end_lap(laps_.back(), lap + 1);
  }

  int finished() const {
    return static_cast<int>(
        std::count_if(laps_.begin(), laps_.end(), [](const auto& l) { return l.finished; }));
  }

  void say(const LapResult& lap) const {
    const auto& times = lap.solve_ms;
    std::fprintf(
        words_,
        "lap %zu: %s, %.2f s, %d steps, %d collision%s, cost %.3f (state %.3f, collision %.3f), mean "
        "%.2f m/s, solve %.2f ms (p99 %.2f)\n",
        laps_.size(), end_name(lap), lap.time, lap.steps, lap.collisions, lap.collisions == 1 ? "" : "s",
        lap.mean_sequence_cost(), lap.state_cost, lap.collision_cost, lap.mean_speed,
        times.empty() ? 0.0 : evaluation::percentile(times, 0.5),
        times.empty() ? 0.0 : evaluation::percentile(times, 0.99));
    if (!lap.estimation.slip_error.empty()) say_estimates(lap.estimation);
    std::fflush(words_);
  }

  /// Says where and why a lap that timed out was blocked. The place is in the map frame.
  void say_stand(const LongestStand& stand) const {
    const maps::Point& origin = scenario_.environment->course.origin;
    std::fprintf(words_, "  blocked for %.1f s at (%.2f, %.2f), yaw %.2f, %.1f m along the lap: %s\n",
                 stand.duration, stand.place.x + origin.x, stand.place.y + origin.y, stand.place.yaw,
                 stand.progress * setup_.length(),
                 stand.every_plan_collides ? "every plan collides or reverses"
                                           : "plans without a collision do not get on");
  }

  void say_estimates(const evaluation::EstimationRecord& record) const {
    const vehicle::ParameterEstimate& last = record.last;
    std::fprintf(words_,
                 "  friction %.3f +- %.3f, plans rely on %.3f; steering gain %.3f +- %.3f, offset %.4f rad, "
                 "delay %.3f +- %.3f s; "
                 "confidence %.2f\n  error of yaw rate %.3f rad/s, slip %.4f rad, speed %.3f m/s (root mean "
                 "square)\n",
                 last.friction, last.friction_deviation, last.cautious_friction, last.steering_gain,
                 last.steering_gain_deviation, last.steering_offset, last.delay, last.delay_deviation,
                 last.confidence, root_mean_square(record.yaw_rate_error),
                 root_mean_square(record.slip_error), root_mean_square(record.speed_error));
  }

  Json summary() const {
    int contacts = 0;
    double cost = 0;
    for (const auto& lap : laps_) {
      contacts += lap.collisions;
      cost += lap.mean_sequence_cost();
    }
    const double chances = static_cast<double>(scenario_.lap.obstacles) * static_cast<double>(laps_.size());
    return {{"laps_finished", finished()},
            {"contacts", contacts},
            {"collision_rate", chances > 0 ? Json(contacts / chances) : Json(nullptr)},
            {"mean_sequence_cost", cost / static_cast<double>(laps_.size())}};
  }

  void write_results() {
    const Json total = summary();
    if (laps_.size() > 1)
      std::fprintf(words_, "%d of %d laps finished, %d collisions, cost %.3f\n", finished(), arguments_.laps,
                   total["contacts"].get<int>(), total["mean_sequence_cost"].get<double>());
    if (recording_) {
      recording_->close();
      std::fprintf(words_, "recording: %s\n", arguments_.record.c_str());
    }
    if (!arguments_.json.empty()) write_json(results(total), arguments_.json);
    if (!arguments_.plot.empty()) {
      draw_lap(map_of(scenario_), setup_, driven_, laps_.back(),
               arguments_.method + " on " + scenario_.environment->course.name, arguments_.plot);
      std::fprintf(words_, "picture: %s\n", arguments_.plot.c_str());
    }
  }

  Json results(const Json& total) const {
    Json json = results_json(settings_, scenario_);
    json["summary"] = total;
    for (const LapResult& lap : laps_)
      json["laps"].push_back(lap_json(lap, static_cast<int>(json["laps"].size()) + 1));
    json["solve_ms"] = times_json(solve_times(laps_));
    return json;
  }

  const DriveArguments& arguments_;
  std::FILE* words_;
  Scenario scenario_;
  evaluation::LapSetup setup_;
  Json settings_;
  std::optional<Recording> recording_;
  DrivenLine driven_;
  std::vector<LapResult> laps_;
};

}  // namespace

void declare_drive(Subcommand& command) {
  command.summary("Drive laps; write results, recordings and pictures");
  const auto arguments = std::make_shared<DriveArguments>();
  add_scenario_options(command, arguments->scenario);
  add_method_option(command, arguments->method);
  command.option("--seed", arguments->seed, "Seed of lap 1; lap k has SEED + (k - 1) (obstacles + 5)");
  command.option("--laps", arguments->laps, "Number of laps; each starts from standstill", {1, 100000});
  command.json(arguments->json, "the results");
  const Option record =
      command.option("--record", arguments->record, "Record every control step to this MCAP file");
  command
      .flag("--record-all", arguments->record_all,
            "Record all candidates, guides and the map of costs, of every control step")
      .needs(record);
  command
      .flag("--record-times", arguments->record_times,
            "Also record wall-clock times, which differ from run to run")
      .needs(record);
  command.option("--plot", arguments->plot, "Write a picture of the last lap to this PNG, SVG or PDF");
  command.examples({"drive --course eel --obstacles 5 --laps 3 --plot lap.png",
                    "drive --method mppi --set mppi.samples=2000 --record lap.mcap"});
  command.action([arguments] { return DriveJob(*arguments).run(); });
}

}  // namespace slalom::tools
