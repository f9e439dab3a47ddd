#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "slalom/core/error.hpp"
#include "slalom/core/files/write_file.hpp"
#include "src/evaluation/json.hpp"
#include "tools/commands/commands.hpp"
#include "tools/commands/replay_against.hpp"
#include "tools/drawing/course_pictures.hpp"
#include "tools/evaluation/stored_evaluation.hpp"
#include "tools/live_view/view_setup.hpp"
#include "tools/recording/recording.hpp"
#include "tools/scenario/lap_json.hpp"
#include "tools/terminal/interrupt.hpp"
#include "tools/video/drive_video.hpp"
#include "tools/video/video_file.hpp"
#include "view/embedded.hpp"
#include "view/recording/encodings.hpp"
#include "view/recording/replay.hpp"
#include "view/server/server.hpp"

namespace slalom::tools {
namespace {

using namespace evaluation;

struct ReplayArguments {
  std::string source;  ///< a recording in MCAP, or the output folder of an evaluation
  std::string html, video, host = "127.0.0.1";
  VideoSpan span;
  std::uint16_t port = 8400;
  std::string method, scenario, course, plot, record;
  int lap = -1;  ///< -1: not given
  std::string against, start, json;
  std::vector<std::string> set;
};

/// The options of a lap of an evaluation, and those of a recording.
constexpr const char* lap_options[] = {"--lap", "--scenario", "--plot", "--method", "--course", "--record"};
constexpr const char* recording_options[] = {"--html", "--host", "--port",  "--video",
                                             "--from", "--to",   "--speed", "--against"};

/// Throws CommandLineError if one of the options was given.
void reject_options(const Subcommand& command, std::span<const char* const> options, const char* when) {
  for (const char* option : options)
    if (command.given(option)) throw CommandLineError(option, std::string("has no effect ") + when);
}

/// Drives the lap again. The exit status: 1 if it differs from the lap of the evaluation.
int replay_lap(const ReplayArguments& arguments) {
  const StoredEvaluation stored = load_evaluation(arguments.source);
  if (arguments.lap < 0) throw CommandLineError("--lap", "is required to repeat a lap of an evaluation");
  const int index = stored.find(arguments.method, arguments.scenario);
  const Experiment& experiment = stored.experiments[static_cast<std::size_t>(index)];
  if (arguments.lap >= experiment.laps)
    throw CommandLineError("--lap", std::to_string(arguments.lap),
                           "must be in [0, " + std::to_string(experiment.laps - 1) + "]");
  Scenario scenario;
  const Evaluation evaluation = rebuild_evaluation(stored, arguments.course, scenario);
  const LapSetup setup = lap_setup(evaluation, index);
  const std::uint64_t seed = lap_seed(evaluation.seed0, arguments.lap, experiment.obstacles);
  std::optional<Recording> recording;
  if (!arguments.record.empty()) {
    const auto settings = parse_json(stored.settings);
    const ScenarioArguments told = evaluation_arguments(stored, arguments.course);
    recording.emplace(arguments.record, RecordingFacts{.arguments = told,
                                                       .scenario = scenario,
                                                       .method = experiment.method,
                                                       .seed = seed,
                                                       .control_period = setup.control_period(),
                                                       .settings = settings});
    recording->begin_lap(seed);
  }
  DrivenLine driven;
  const LapResult lap = run_lap(setup, seed, [&](const ControlStep& tick) {
    if (recording) recording->add(tick);
    driven.points.push_back({tick.seen.pose.x, tick.seen.pose.y});
    driven.speeds.push_back(tick.seen.speed);
  });
  std::printf("%s, %s, lap %d, seed %llu: %s, %.2f s, %d collisions, cost %.3f\n", experiment.label().c_str(),
              experiment.scenario.c_str(), arguments.lap, static_cast<unsigned long long>(seed),
              end_name(lap), lap.time, lap.collisions, lap.mean_sequence_cost());
  if (recording) {
    recording->end_lap(lap, arguments.lap);
    recording->close();
    std::printf("recording: %s\n", arguments.record.c_str());
  }
  if (!arguments.plot.empty()) {
    draw_lap(map_of(scenario), setup, driven, lap,
             experiment.label() + " on " + evaluation.environment->course.name, arguments.plot);
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

/// Writes a part of a recording as a video.
int film_recording(const ReplayArguments& arguments) {
  if (!VideoFile::knows(arguments.video))
    throw CommandLineError("--video", arguments.video, "must end with .gif, .webm, .mp4 or .webp");
  if (arguments.span.to <= arguments.span.from) throw CommandLineError("--to", "must be larger than --from");
  const int pictures = write_video(RecordedDrive(arguments.source), arguments.span, arguments.video);
  std::printf("video: %s, %d pictures, %.1f s\n", arguments.video.c_str(), pictures, pictures / 25.0);
  return 0;
}

/// Serves a recording in the page of the live view until it is interrupted, or writes it as an HTML page.
int replay_recording(const ReplayArguments& arguments) {
  std::uint64_t lost = 0;
  const std::string page =
      view::replay_page(view::gunzip(view::page_gzip()), view::load_replay(arguments.source, &lost));
  if (lost > 0)
    std::fprintf(stderr, "note: %s was cut: its last %llu bytes cannot be read\n", arguments.source.c_str(),
                 static_cast<unsigned long long>(lost));
  if (!arguments.html.empty()) {
    write_file(arguments.html, page);
    std::printf("replay: %s, opens in any browser\n", arguments.html.c_str());
    return 0;
  }
  view::ServerOptions options = server_options(arguments.host, arguments.port, "");
  view::Server server(options, {{"/", {"text/html; charset=utf-8", page}}});
  const InterruptFlag interrupt;
  print_address(view::address_of(server, options));
  while (!interrupt.raised()) {
    server.wait(std::chrono::milliseconds(100));
    server.take();
  }
  return 0;
}

/// Throws IoError if `source` is a bag of rosbag2: it has messages of a drive, but not its pictures.
void reject_bag(const std::filesystem::path& source) {
  if (source.extension() == ".db3" || std::filesystem::exists(source / "metadata.yaml"))
    throw IoError(source.string(), 0,
                  "is a bag of rosbag2, which slalom identify and slalom course --line read; to look at it, "
                  "use Foxglove or rviz2");
}

/// Compares a planner with the driver of a recording.
int compare_planner(const ReplayArguments& arguments) {
  AgainstArguments against;
  against.recording = arguments.source;
  against.json = arguments.json;
  against.plot = arguments.plot;
  against.scenario.course = arguments.course;
  against.scenario.config = arguments.against;
  against.scenario.set = arguments.set;
  against.scenario.start = arguments.start;
  if (!arguments.method.empty()) against.method = arguments.method;
  return replay_against(against);
}

int replay(const ReplayArguments& arguments, const Subcommand& command) {
  if (!arguments.against.empty()) return compare_planner(arguments);
  reject_bag(arguments.source);
  if (std::filesystem::is_directory(arguments.source)) {
    reject_options(command, recording_options, "when a lap of an evaluation is repeated");
    return replay_lap(arguments);
  }
  reject_options(command, lap_options, "when a recording is replayed");
  if (!arguments.video.empty()) return film_recording(arguments);
  return replay_recording(arguments);
}

}  // namespace

void declare_replay(Subcommand& command) {
  command.summary("Show a recording in the browser, or repeat a lap of an evaluation");
  const auto arguments = std::make_shared<ReplayArguments>();
  command
      .option("what", arguments->source,
              "MCAP recording, output folder of an evaluation, or with --against a bag of rosbag2")
      .required();
  const Option html =
      command.option("--html", arguments->html, "Write the recording as an HTML page instead of serving it");
  Option video = command.option(
      "--video", arguments->video,
      "Write the recording as a video from above (GIF, WebM, MP4, WebP) instead; needs the program ffmpeg");
  video.excludes(html);
  command.option("--from", arguments->span.from, "Video: first second of the recording", {0, 1e6})
      .needs(video);
  command.option("--to", arguments->span.to, "Video: last second of the recording", {0, 1e6}).needs(video);
  command.option("--speed", arguments->span.speed, "Video: speed; 0.5 is slow motion", {0.01, 100})
      .needs(video);
  const Option host = command.option("--host", arguments->host, "Address to listen on");
  const Option port = command.option("--port", arguments->port, "Port to listen on; 0 means any free port");
  const Option lap =
      command.option("--lap", arguments->lap, "Evaluation: number of the lap, from 0", {0, 999999});
  command.option("--method", arguments->method,
                 "Evaluation: method, or method and options as in the results");
  const Option scenario = command.option("--scenario", arguments->scenario, "Evaluation: pt or oa");
  const Option course =
      command.option("--course", arguments->course,
                     "With --against: course; evaluation: its folder, if it is not found by name");
  command.option("--plot", arguments->plot,
                 "Evaluation, or with --against: write a picture of the drive to this PNG, SVG or PDF");
  const Option record =
      command.option("--record", arguments->record, "Evaluation: record the lap to this MCAP file");
  Option against = command.option(
      "--against", arguments->against,
      "Compare the planner of this configuration with the driver of a recording with all scans, or of a bag");
  against.needs(course).excludes(html).excludes(video).excludes(record).excludes(lap).excludes(scenario);
  command
      .option("--set", arguments->set,
              "With --against: section.option=value of the configuration; may be repeated")
      .repeatable()
      .needs(against);
  command
      .option("--start", arguments->start,
              "With --against: first pose x,y,yaw of the rear axle, for a bag without poses on the map "
              "[searched on the whole map]")
      .needs(against);
  command.option("--json", arguments->json, "With --against: write all moments to this file (- for stdout)")
      .needs(against);
  for (Option served : {host, port}) served.excludes(html).excludes(video).excludes(record).excludes(against);
  command.examples({"replay lap.mcap", "replay lap.mcap --video lap.webm --from 4 --to 8 --speed 0.5",
                    "replay OUT --lap 3 --method svg_mppi --plot lap.png",
                    "replay bag --against default --course my_course --plot against.png"});
  command.action([arguments, &command] { return replay(*arguments, command); });
}

}  // namespace slalom::tools
