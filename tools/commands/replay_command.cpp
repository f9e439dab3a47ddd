#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>

#include "slalom/core/error.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "src/evaluation/json.hpp"
#include "tools/commands/commands.hpp"
#include "tools/drawing/lap_picture.hpp"
#include "tools/evaluation/stored_evaluation.hpp"
#include "tools/recording/recording.hpp"
#include "tools/recording/replay_recording.hpp"
#include "tools/report/lap_json.hpp"

namespace slalom::tools {
namespace {

using namespace evaluation;

struct ReplayCommandArguments {
  ReplayArguments recording;
  std::string folder, method, scenario, course, plot, record;
  int lap = 0;
  bool lap_given = false;
};

/// The options of a lap of an evaluation, and those of a recording.
constexpr const char* lap_options[] = {"--lap", "--scenario", "--plot", "--method", "--course", "--record"};
constexpr const char* recording_options[] = {"--html", "--host", "--port"};

/// Throws CommandLineError if one of the options was given.
void reject_options(const Subcommand& command, std::span<const char* const> options, const char* when) {
  for (const char* option : options)
    if (command.given(option)) throw CommandLineError(option, std::string("has no effect ") + when);
}

void plot(const ReplayCommandArguments& arguments, const Scenario& scenario, const LapSetup& setup,
          const DrivenLine& driven, const LapResult& lap, const std::string& label) {
  char facts[200];
  std::snprintf(
      facts, sizeof facts,
      "%s after %.2f s \xC2\xB7 mean %.2f m/s \xC2\xB7 %d collisions \xC2\xB7 cost %.2f \xC2\xB7 seed %llu",
      lap.finished ? "finished" : "timeout", lap.time, lap.mean_speed, lap.collisions, lap.mean_sequence_cost,
      static_cast<unsigned long long>(lap.seed));
  const auto map = vehicle::load_course(scenario.folder).map;
  draw_lap({.map = map,
            .path = scenario.environment->path,
            .closed = scenario.environment->course.closed,
            .driven = driven,
            .lap = lap,
            .start = setup.start(),
            .title = label,
            .facts = facts},
           arguments.plot);
}

/// Drives the lap again. The exit status: 1 if it differs from the lap of the evaluation.
int replay_lap(const ReplayCommandArguments& arguments) {
  const StoredEvaluation stored = load_evaluation(arguments.folder);
  if (!arguments.lap_given) throw CommandLineError("--lap", "is required to repeat a lap of an evaluation");
  const int index = stored.find(arguments.method, arguments.scenario);
  const Experiment& experiment = stored.experiments[static_cast<std::size_t>(index)];
  if (arguments.lap < 0 || arguments.lap >= experiment.laps)
    throw CommandLineError("--lap", std::to_string(arguments.lap),
                           "must be in [0, " + std::to_string(experiment.laps - 1) + "]");
  Scenario scenario;
  const Evaluation evaluation = rebuild_evaluation(stored, arguments.course, scenario);
  const LapSetup setup = lap_setup(evaluation, index);
  const std::uint64_t seed = lap_seed(evaluation.seed0, arguments.lap, experiment.obstacles);
  std::unique_ptr<Recording> recording;
  if (!arguments.record.empty()) {
    const auto settings = parse_json(stored.settings);
    const ScenarioArguments told = evaluation_arguments(stored, arguments.course);
    recording = make_recording(arguments.record, {.arguments = told,
                                                  .scenario = scenario,
                                                  .method = experiment.method,
                                                  .seed = seed,
                                                  .control_period = setup.control_period(),
                                                  .settings = settings});
    recording->begin_lap(arguments.lap, seed);
  }
  DrivenLine driven;
  const LapResult lap = run_lap(setup, seed, [&](const ControlStep& tick) {
    if (recording) recording->add(tick);
    driven.points.push_back({tick.seen.pose.x, tick.seen.pose.y});
    driven.speeds.push_back(tick.seen.speed);
  });
  std::printf("%s, %s, lap %d, seed %llu: %s, %.2f s, %d collisions, cost %.3f\n", experiment.label().c_str(),
              experiment.scenario.c_str(), arguments.lap, static_cast<unsigned long long>(seed),
              lap.finished ? "finished" : "timeout", lap.time, lap.collisions, lap.mean_sequence_cost);
  if (recording) {
    recording->end_lap(lap, arguments.lap);
    recording->close();
    std::printf("recording: %s\n", arguments.record.c_str());
  }
  if (!arguments.plot.empty()) {
    plot(arguments, scenario, setup, driven, lap,
         experiment.label() + " on " + evaluation.environment->course.name);
    std::printf("picture: %s\n", arguments.plot.c_str());
  }
  const LapRow now = make_row(index, arguments.lap, lap, 0);
  const auto kept = std::find_if(stored.rows.begin(), stored.rows.end(), [&](const LapRow& row) {
    return row.experiment == index && row.lap == arguments.lap;
  });
  if (kept == stored.rows.end()) {
    std::printf("the evaluation does not contain this lap yet\n");
    return 0;
  }
  const bool same = same_lap(now, *kept, stored.experiments);
  std::printf(same ? "identical to the lap of the evaluation, bit for bit\n"
                   : "NOT identical to the lap of the evaluation, which was driven by another version or "
                     "instruction set\n");
  return same ? 0 : 1;
}

int replay(ReplayCommandArguments& arguments, const Subcommand& command) {
  if (std::filesystem::is_directory(arguments.folder)) {
    reject_options(command, recording_options, "when a lap of an evaluation is repeated");
    arguments.lap_given = command.given("--lap");
    return replay_lap(arguments);
  }
  reject_options(command, lap_options, "when a recording is replayed");
  arguments.recording.file = arguments.folder;
  return replay_recording(arguments.recording);
}

}  // namespace

void declare_replay(Subcommand& command) {
  command.summary("Show a recording in the browser, or repeat a lap of an evaluation");
  const auto arguments = std::make_shared<ReplayCommandArguments>();
  command.option("what", arguments->folder, "MCAP recording, or output folder of an evaluation").required();
  const Option html = command.option("--html", arguments->recording.html,
                                     "Write the recording as an HTML page instead of serving it");
  const Option host =
      command.option("--host", arguments->recording.host, "Address to listen on").show_default();
  const Option port =
      command.option("--port", arguments->recording.port, "Port to listen on; 0 means any free port")
          .show_default();
  command.option("--lap", arguments->lap, "Evaluation: number of the lap, from 0");
  command.option("--method", arguments->method,
                 "Evaluation: method, or method and options as in the results");
  command.option("--scenario", arguments->scenario, "Evaluation: pt or oa");
  command.option("--course", arguments->course, "Evaluation: course folder, if it is not found by name");
  command.option("--plot", arguments->plot, "Evaluation: write a picture of the lap to this PNG, SVG or PDF");
  const Option record = command.option(
      "--record", arguments->record,
      "Evaluation: record the lap to this file: MCAP if its name ends in .mcap, otherwise JSON lines");
  for (Option served : {host, port}) served.excludes(html).excludes(record);
  command.action([arguments, &command] { return replay(*arguments, command); });
}

}  // namespace slalom::tools
