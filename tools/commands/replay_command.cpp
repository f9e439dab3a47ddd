
#include "slalom/core/error.hpp"
#include "slalom/view/serve.hpp"
#include "tools/commands/commands.hpp"
#include "tools/commands/replay_against.hpp"
#include "tools/live_view/view_setup.hpp"
#include "tools/recording/replay_page.hpp"
#include "tools/terminal/interrupt.hpp"
#include "view/server/server.hpp"

namespace slalom::tools {
namespace {

struct ReplayArguments {
  AgainstArguments against;  ///< the recording, and the planner beside its driver
  std::string host = "127.0.0.1";
  std::uint16_t port = 8400;
};

/// Serves a recording in the page of the live view until it is interrupted.
int replay(const ReplayArguments& arguments) {
  const std::filesystem::path recording = arguments.against.recording;
  if (recording.extension() == ".db3" || std::filesystem::exists(recording / "metadata.yaml"))
    throw IoError(
        recording.string(), 0,
        "is a bag of rosbag2, which slalom identify, slalom course --line and slalom replay --against "
        "read; to look at it, use Foxglove or rviz2");
  const view::ServerOptions options = server_options(arguments.host, arguments.port, "");
  view::Server server(options, {{"/", {"text/html; charset=utf-8", page_of_recording(recording)}}});
  const InterruptFlag interrupt;
  view::print_address(view::address_of(server, options));
  while (!interrupt.raised()) {
    server.wait(std::chrono::milliseconds(100));
    server.take();
  }
  return 0;
}

}  // namespace

void declare_replay(Subcommand& command) {
  command.summary("Show a recording in the browser, or compare a planner with the driver of a recording");
  const auto arguments = std::make_shared<ReplayArguments>();
  AgainstArguments& against = arguments->against;
  command.option("recording", against.recording,
                 "Recording in MCAP, or with --against a bag of rosbag2 (file or folder)",
                 {.required = true});
  command.option("--host", arguments->host, "Address to listen on");
  command.option("--port", arguments->port, "Port to listen on; 0 means any free port");
  against.scenario.config.clear();
  command.option(
      "--against", against.scenario.config,
      "Compare the planner of this configuration with the driver of a recording with all scans, or of a bag",
      {.excludes = {"--host", "--port"}});
  const Rules with_planner{.needs = "--against"};
  against.scenario.course.clear();
  command.option("--course", against.scenario.course, "With --against: course name or folder", with_planner);
  command.option("--method", against.method, "With --against: one of " + method_names(), with_planner);
  command.option("--set", against.scenario.set,
                 "With --against: section.option=value of the configuration; may be repeated", with_planner);
  command.option("--start", against.scenario.start,
                 "With --against: first pose x,y,yaw of the rear axle, for a bag without poses on the map "
                 "[searched on the whole map]",
                 with_planner);
  command.option("--plot", against.plot,
                 "With --against: write a picture of drive and plans to this PNG, SVG or PDF", with_planner);
  command.option("--json", against.json, "With --against: write all moments to this file (- for stdout)",
                 with_planner);
  command.examples({"replay lap.mcap", "replay bag --against default --course my_course --plot against.png"});
  command.action([arguments, &command] {
    if (command.given("--against") && !command.given("--course"))
      throw CommandLineError("--against", "needs --course");
    return command.given("--against") ? replay_against(arguments->against) : replay(*arguments);
  });
}

}  // namespace slalom::tools
