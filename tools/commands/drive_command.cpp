
#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "slalom/evaluation/statistics.hpp"
#include "tools/commands/commands.hpp"
#include "tools/drawing/course_pictures.hpp"
#include "tools/evaluation/stored_evaluation.hpp"
#include "tools/recording/driven_recording.hpp"
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
  std::string again, experiment_scenario;  ///< folder of an evaluation; "pt", "oa" or empty
  int lap = -1;                            ///< lap of the evaluation; -1: not given
};

/// Laps to be driven.
struct Drive {
  ScenarioArguments arguments;
  Scenario scenario;
  std::string method, label;  ///< `label` also has the options of an experiment
  std::uint64_t seed = 0;     ///< seed of the first lap
  int laps = 1, first = 1;    ///< number of laps, and the number by which the first one is called

  evaluation::LapSetup setup() const {
    return {scenario.environment, {scenario.configuration, method}, scenario.lap};
  }
};

/// The longest time that a car stood in a lap.
class LongestStand {
 public:
  void add(const evaluation::ControlStep& step) {
    if (std::abs(step.seen.speed) > moving ||
        std::hypot(step.seen.pose.x - at_.x, step.seen.pose.y - at_.y) > near) {
      at_ = step.seen.pose;
      since_ = step.time;
      steps_.fill(0);
    }
    ++steps_[static_cast<std::size_t>(step.output.status)];
    if (step.time - since_ <= duration) return;
    duration = step.time - since_;
    place = at_;
    progress = step.progress;
    status = static_cast<Status>(std::max_element(steps_.begin(), steps_.end()) - steps_.begin());
  }
  const char* reason() const {
    return status == Status::blocked        ? "every plan collides or reverses"
           : status == Status::bad_odometry ? "its place is not known, so it brakes"
                                            : "plans without a collision do not get on";
  }

  using Status = vehicle::PlannerStatus;
  double duration = 0;         ///< s
  maps::Pose place;            ///< pose of the centre of gravity
  double progress = 0;         ///< share of the lap
  Status status = Status::ok;  ///< most frequent one

 private:
  static constexpr double moving = 1.0, near = 1.0;  // m/s, m
  maps::Pose at_;
  double since_ = 0;
  std::array<int, 7> steps_{};  ///< with each status
};

/// A drive of several laps and its outputs.
class DriveJob {
 public:
  DriveJob(const DriveArguments& arguments, Drive drive)
      : arguments_(arguments),
        words_(arguments.json == "-" ? stderr : stdout),
        drive_(std::move(drive)),
        setup_(drive_.setup()),
        settings_(settings_json(drive_.arguments, drive_.scenario, drive_.method)) {
    setup_.validate();
    settings_["seed"] = drive_.seed;
    settings_["laps"] = drive_.laps;
    settings_["timeout_s"] = setup_.timeout();
    settings_["control_period_s"] = setup_.control_period();
    if (!arguments.record.empty())
      recording_.emplace(arguments.record, RecordingFacts{.arguments = drive_.arguments,
                                                          .scenario = drive_.scenario,
                                                          .method = drive_.method,
                                                          .seed = drive_.seed,
                                                          .control_period = setup_.control_period(),
                                                          .settings = settings_,
                                                          .everything = arguments.record_all,
                                                          .times = arguments.record_times});
  }

  /// Drives the laps and writes the results, also of the laps before an error. Returns the exit status.
  int run() {
    const int obstacles = setup_.settings.obstacles;
    print_notes(words_, drive_.scenario);
    std::fprintf(words_, "%s on %s, configuration %s, evaluation %s, %d obstacle%s, seed %llu\n",
                 drive_.label.c_str(), setup_.environment->course.name.c_str(),
                 drive_.arguments.config.c_str(), drive_.arguments.evaluation.c_str(), obstacles,
                 obstacles == 1 ? "" : "s", static_cast<unsigned long long>(drive_.seed));
    try {
      const InterruptFlag interrupt;
      for (int lap = 0; lap < drive_.laps && !interrupt.raised(); ++lap) drive(lap, interrupt.raised());
    } catch (...) {
      if (!laps_.empty()) write_results();
      throw;
    }
    if (!laps_.empty()) write_results();
    return finished() == drive_.laps ? 0 : 1;
  }

  const std::vector<LapResult>& laps() const { return laps_; }
  std::FILE* words() const { return words_; }

 private:
  void drive(int lap, const std::atomic<bool>& interrupted) {
    const std::uint64_t seed = evaluation::lap_seed(drive_.seed, lap, setup_.settings.obstacles);
    if (recording_) recording_->begin_lap(seed);
    driven_ = {};
    LongestStand stand;
    LapResult result;
    {
      ProgressLine progress(words_);
      const auto on_step = [&](const evaluation::ControlStep& tick) {
        progress.show(lap + drive_.first, drive_.laps, tick);
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
    if (recording_) recording_->end_lap(laps_.back(), lap + drive_.first);
  }

  int last_number() const { return drive_.first + static_cast<int>(laps_.size()) - 1; }
  int finished() const {
    return static_cast<int>(
        std::count_if(laps_.begin(), laps_.end(), [](const auto& l) { return l.finished; }));
  }

  void say(const LapResult& lap) const {
    const auto& times = lap.solve_ms;
    std::fprintf(words_,
                 "lap %d: %s, %.2f s, %d steps, %d collision%s, cost %.3f\n"
                 "  state cost %.3f, collision cost %.3f; mean %.2f m/s; solve %.2f ms (p99 %.2f)\n",
                 last_number(), end_name(lap), lap.time, lap.steps, lap.collisions,
                 lap.collisions == 1 ? "" : "s", lap.mean_sequence_cost(), lap.state_cost, lap.collision_cost,
                 lap.mean_speed, times.empty() ? 0.0 : evaluation::percentile(times, 0.5),
                 times.empty() ? 0.0 : evaluation::percentile(times, 0.99));
    if (!lap.estimation.slip_error.empty()) say_estimates(lap.estimation);
    std::fflush(words_);
  }

  /// Says where and why a lap that timed out was blocked. The place is in the map frame.
  void say_stand(const LongestStand& stand) const {
    const maps::Point& origin = setup_.environment->course.origin;
    std::fprintf(words_, "  blocked for %.1f s at (%.2f, %.2f), yaw %.2f, %.1f m along the lap: %s\n",
                 stand.duration, stand.place.x + origin.x, stand.place.y + origin.y, stand.place.yaw,
                 stand.progress * setup_.length(), stand.reason());
  }

  void say_estimates(const evaluation::EstimationRecord& record) const {
    const vehicle::ParameterEstimate& last = record.last;
    std::fprintf(words_,
                 "  friction %.3f +- %.3f, plans rely on %.3f; steering gain %.3f +- %.3f,\n"
                 "  offset %.4f rad, delay %.3f +- %.3f s; confidence %.2f\n"
                 "  rms errors: yaw rate %.3f rad/s, slip %.4f rad, speed %.3f m/s\n",
                 last.friction, last.friction_deviation, last.cautious_friction, last.steering_gain,
                 last.steering_gain_deviation, last.steering_offset, last.delay, last.delay_deviation,
                 last.confidence, root_mean_square(record.yaw_rate_error),
                 root_mean_square(record.slip_error), root_mean_square(record.speed_error));
  }

  Json summary() const {
    int collisions = 0;
    double cost = 0;
    for (const auto& lap : laps_) {
      collisions += lap.collisions;
      cost += lap.mean_sequence_cost();
    }
    const double chances = static_cast<double>(setup_.settings.obstacles) * static_cast<double>(laps_.size());
    return {{"finished", finished()},
            {"collisions", collisions},
            {"collision_rate", chances > 0 ? Json(collisions / chances) : Json(nullptr)},
            {"ms_mean", cost / static_cast<double>(laps_.size())}};
  }

  void write_results() {
    const Json total = summary();
    if (laps_.size() > 1)
      std::fprintf(words_, "%d of %d laps finished, %d collisions, cost %.3f\n", finished(), drive_.laps,
                   total["collisions"].get<int>(), total["ms_mean"].get<double>());
    if (recording_) {
      recording_->close();
      std::fprintf(words_, "recording: %s\n", arguments_.record.c_str());
    }
    if (!arguments_.json.empty()) write_json(results(total), arguments_.json);
    if (!arguments_.plot.empty()) {
      draw_lap(map_of(drive_.scenario), setup_, driven_, laps_.back(),
               drive_.label + " on " + setup_.environment->course.name, arguments_.plot);
      std::fprintf(words_, "picture: %s\n", arguments_.plot.c_str());
    }
  }

  Json results(const Json& total) const {
    Json json = results_json(settings_, drive_.scenario);
    json["summary"] = total;
    for (int number = drive_.first; const LapResult& lap : laps_)
      json["laps"].push_back(lap_json(lap, number++));
    json["solve_ms"] = times_json(solve_times(laps_));
    return json;
  }

  const DriveArguments& arguments_;
  std::FILE* words_;
  Drive drive_;
  evaluation::LapSetup setup_;
  Json settings_;
  std::optional<Recording> recording_;
  DrivenLine driven_;
  std::vector<LapResult> laps_;
};

int drive(const DriveArguments& arguments) {
  return DriveJob(arguments, {.arguments = arguments.scenario,
                              .scenario = load_scenario(arguments.scenario, arguments.method),
                              .method = arguments.method,
                              .label = arguments.method,
                              .seed = arguments.seed,
                              .laps = arguments.laps})
      .run();
}

/// Drives a lap of an evaluation again. The exit status: 1 if it differs from the lap of the evaluation.
int drive_again(const DriveArguments& arguments, const std::string& method, const std::string& course) {
  const StoredEvaluation stored = load_evaluation(arguments.again);
  if (arguments.lap < 0) throw CommandLineError("--lap", "is required with --again");
  const int index = stored.find(method, arguments.experiment_scenario);
  const evaluation::Experiment& experiment = stored.experiments[static_cast<std::size_t>(index)];
  if (arguments.lap >= experiment.laps)
    throw CommandLineError("--lap", std::to_string(arguments.lap),
                           "must be in [0, " + std::to_string(experiment.laps - 1) + "]");
  Drive again{.arguments = evaluation_arguments(stored, course),
              .scenario = {},
              .method = experiment.method,
              .label = experiment.label(),
              .first = arguments.lap};
  const evaluation::Evaluation evaluation = rebuild_evaluation(stored, course, again.scenario);
  const evaluation::LapSetup setup = lap_setup(evaluation, index);
  again.scenario.configuration = setup.driver.configuration;
  again.scenario.lap = setup.settings;
  again.scenario.lap.threads = arguments.scenario.threads;
  again.arguments.obstacles = experiment.obstacles;
  for (const auto& [key, value] : experiment.set) again.arguments.set.push_back(key + "=" + value);
  again.seed = evaluation::lap_seed(evaluation.seed0, arguments.lap, experiment.obstacles);

  DriveJob job(arguments, std::move(again));
  job.run();
  if (job.laps().empty() || job.laps().front().cancelled) return 1;
  const auto kept = std::find_if(stored.rows.begin(), stored.rows.end(), [&](const evaluation::LapRow& row) {
    return row.experiment == index && row.lap == arguments.lap;
  });
  const bool same =
      kept != stored.rows.end() &&
      same_lap(make_row(index, arguments.lap, job.laps().front(), 0), *kept, stored.experiments);
  std::fprintf(job.words(), "%s\n",
               kept == stored.rows.end() ? "the evaluation does not contain this lap yet"
               : same                    ? "identical to the lap of the evaluation, bit for bit"
                                         : "NOT identical to the lap of the evaluation, which was driven by "
                                           "another version or instruction set");
  return same || kept == stored.rows.end() ? 0 : 1;
}

/// Throws CommandLineError if an option is given that a lap that is driven again takes from its evaluation.
void check_again(const Subcommand& command) {
  if (!command.given_only({"--again", "--lap", "--scenario", "--method", "--course", "--threads", "--json",
                           "--record", "--record-all", "--record-times", "--plot"}))
    throw CommandLineError("--again",
                           "has only --lap, --scenario, --method, --course, --threads and outputs beside it");
}

}  // namespace

void declare_drive(Subcommand& command) {
  command.summary("Drive laps; write results, recordings and pictures");
  const auto arguments = std::make_shared<DriveArguments>();
  add_scenario_options(command, arguments->scenario);
  add_method_option(command, arguments->method);
  command.option("--seed", arguments->seed, "Seed of lap 1; lap k has SEED + (k - 1) (obstacles + 5)");
  command.option("--laps", arguments->laps, "Number of laps; each starts from standstill", {1, 100000});
  command.json(arguments->json, "the results");
  command.option("--record", arguments->record, "Record every control step to this MCAP file");
  command.flag("--record-all", arguments->record_all,
               "Record all candidates, guides and the map of costs, of every control step",
               {.needs = "--record"});
  command.flag("--record-times", arguments->record_times,
               "Also record wall-clock times, which differ from run to run", {.needs = "--record"});
  command.option("--plot", arguments->plot, "Write a picture of the last lap to this PNG, SVG or PDF");
  command.option("--again", arguments->again,
                 "Drive a lap of this evaluation (output folder of slalom eval) again, under its settings; "
                 "--method may also have options, as in the results, and --course the course's new folder. "
                 "The exit status is 1 unless it is the same to the last bit");
  command.option("--lap", arguments->lap, "With --again: number of the lap, from 0",
                 {.least = 0, .most = 999999, .needs = "--again"});
  command.option("--scenario", arguments->experiment_scenario, "With --again: pt or oa",
                 {.needs = "--again"});
  command.examples({"drive --course eel --obstacles 5 --laps 3 --plot lap.png",
                    "drive --method mppi --set mppi.samples=2000 --record lap.mcap",
                    "drive --again OUT --method svg_mppi --lap 3 --plot lap.png"});
  command.action([arguments, &command] {
    if (arguments->again.empty()) return drive(*arguments);
    check_again(command);
    return drive_again(*arguments, command.given("--method") ? arguments->method : "",
                       command.given("--course") ? arguments->scenario.course : "");
  });
}

}  // namespace slalom::tools
