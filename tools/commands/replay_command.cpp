#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "slalom/evaluation/statistics.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "slalom/vehicle/localisation/localiser.hpp"
#include "slalom/view/serve.hpp"
#include "tools/command_line/words.hpp"
#include "tools/commands/commands.hpp"
#include "tools/drawing/course_pictures.hpp"
#include "tools/live_view/view_setup.hpp"
#include "tools/recording/driven_recording.hpp"
#include "tools/recording/replay_page.hpp"
#include "tools/scenario/scenario.hpp"
#include "tools/terminal/interrupt.hpp"
#include "tools/terminal/json_output.hpp"
#include "view/server/server.hpp"

namespace slalom::tools {
namespace {

/// A recorded drive, and the planner that is compared with its driver.
struct AgainstArguments {
  std::string recording;
  ScenarioArguments scenario;  ///< course, configuration, options, and where an unlocalised drive began
  std::string method = "svg_mppi";
  std::string json, plot;
};

using vehicle::DrivenSample;

constexpr double longest_gap = 0.2;  // s between samples that are interpolated

/// A moment of the drive: what the driver commanded, and what the planner would have.
struct Moment {
  double time = 0, speed = 0;  ///< s, m/s
  maps::Pose pose;             ///< pose of the rear axle, map frame
  Command driven, planned;
  vehicle::PlannerStatus status{};

  double steering() const { return std::abs(planned.steer - driven.steer); }
};

/// The state of the car at a time, and the command that was sent then; none where samples are missing.
std::optional<DrivenSample> sample_at(const std::vector<DrivenSample>& samples, double time) {
  const auto next = std::lower_bound(samples.begin(), samples.end(), time - 1e-9,
                                     [](const DrivenSample& each, double at) { return each.time < at; });
  if (next == samples.end()) return std::nullopt;
  DrivenSample sample = *next;
  if (next->time > time + 1e-9) {
    if (next == samples.begin() || next->time - next[-1].time > longest_gap) return std::nullopt;
    const DrivenSample& before = next[-1];
    const double share = (time - before.time) / (next->time - before.time);
    sample.x = before.x + share * (next->x - before.x);
    sample.y = before.y + share * (next->y - before.y);
    sample.yaw = before.yaw + share * maps::wrap_angle(next->yaw - before.yaw);
    sample.speed = before.speed + share * (next->speed - before.speed);
  }
  const bool known = std::isfinite(sample.x + sample.y + sample.yaw + sample.speed + sample.steer_command +
                                   sample.speed_command);
  return known ? std::optional(sample) : std::nullopt;
}

/// The usual time between scans, s.
double scan_interval(const DrivenRecording& drive, const std::string& file) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < drive.scans.size(); ++i)
    intervals.push_back(drive.scans[i].time - drive.scans[i - 1].time);
  if (intervals.size() < 10) throw IoError(file, 0, "must have more than ten scans");
  if (drive.topics.empty() && 2 * drive.scans.size() < drive.samples.size())
    throw IoError(file, 0, "has only some of the scans; record the drive with --record-all");
  return evaluation::percentile(intervals, 0.5);
}

/// A planner beside the driver of a recording.
class Comparison {
 public:
  Comparison(const DrivenRecording& drive, const evaluation::LapSetup& setup)
      : drive_(drive), setup_(setup), planner_(evaluation::make_planner(setup)) {
    if (drive.in_map) return;
    vehicle::LocaliserOptions options{.laser_x = setup.driver.configuration.planner.laser_x};
    localiser_.emplace(vehicle::reachable_map(setup.environment->course), options);
    if (setup.settings.start) localiser_->start_at(*setup.settings.start);
  }

  /// Plans at every `stride`-th scan. Where the drive is not known for long, the planner begins anew.
  std::vector<Moment> run(std::size_t stride) {
    for (std::size_t i = 0; i < drive_.scans.size(); i += stride) plan(drive_.scans[i]);
    return std::move(moments_);
  }

  std::size_t unknown() const { return unknown_; }
  const DrivenLine& driven() const { return driven_; }
  const std::vector<std::vector<maps::Point>>& plans() const { return plans_; }

 private:
  void plan(const RecordedScan& scan) {
    const maps::Point& origin = setup_.environment->course.origin;
    const std::optional<DrivenSample> sample = sample_at(drive_.samples, scan.time);
    vehicle::Odometry odometry;
    if (sample)
      odometry = {.pose = {sample->x - origin.x, sample->y - origin.y, sample->yaw}, .speed = sample->speed};
    if (!sample || (localiser_ && !localise(scan, odometry))) {
      ++unknown_;
      return;
    }
    if (!moments_.empty() && scan.time - moments_.back().time > longest_gap) planner_.reset(0);
    const Command driven{sample->steer_command, sample->speed_command};
    const vehicle::PlannerOutput& output =
        planner_.update({.scan = scan.view(), .odometry = odometry, .obeyed = driven});
    const maps::Pose& at = odometry.pose;
    moments_.push_back({scan.time,
                        sample->speed,
                        {at.x + origin.x, at.y + origin.y, at.yaw},
                        driven,
                        output.command,
                        output.status});
    driven_.points.push_back({at.x, at.y});
    driven_.speeds.push_back(sample->speed);
    if (scan.time < next_plan_) return;
    next_plan_ = scan.time + 0.5;
    plans_.emplace_back();
    for (const auto& state : output.predicted) plans_.back().push_back({state.pose.x, state.pose.y});
  }

  /// Replaces a pose of odometry by the one on the map; false while it is not known.
  bool localise(const RecordedScan& scan, vehicle::Odometry& odometry) {
    const vehicle::LocaliserOutput& out = localiser_->update({scan.view(), odometry.pose, scan.time});
    odometry.pose = out.pose;
    for (std::size_t i = 0; i < odometry.covariance.size(); ++i)
      std::copy(std::begin(out.covariance[i]), std::end(out.covariance[i]), odometry.covariance[i].begin());
    return out.status == vehicle::LocaliserStatus::ok;
  }

  const DrivenRecording& drive_;
  const evaluation::LapSetup& setup_;
  vehicle::Planner planner_;
  std::optional<vehicle::Localiser> localiser_;
  std::vector<Moment> moments_;
  std::size_t unknown_ = 0;  ///< scans at which the state of the car is not known
  DrivenLine driven_;
  std::vector<std::vector<maps::Point>> plans_;
  double next_plan_ = 0;  ///< s, when the next plan is kept for the picture
};

/// Prints a row of differences and adds it to the JSON.
void tell(std::FILE* out, Json& json, const char* words, const char* key, const std::vector<double>& values) {
  Json row;
  std::fprintf(out, "%-16s", words);
  for (const auto& [name, share] : {std::pair{"median", 0.5}, {"percentile_95", 0.95}, {"largest", 1.0}}) {
    row[name] = evaluation::percentile(values, share);
    std::fprintf(out, " %9.3f", row[name].get<double>());
  }
  std::fprintf(out, "\n");
  json[key] = row;
}

/// The moments with the largest differences in steering, at least a second from each other.
std::vector<Moment> most_different(std::vector<Moment> moments) {
  std::stable_sort(moments.begin(), moments.end(),
                   [](const Moment& a, const Moment& b) { return a.steering() > b.steering(); });
  std::vector<Moment> chosen;
  for (const Moment& moment : moments) {
    const bool apart = std::all_of(chosen.begin(), chosen.end(),
                                   [&](const Moment& c) { return std::abs(c.time - moment.time) >= 1; });
    if (apart && chosen.size() < 5) chosen.push_back(moment);
  }
  return chosen;
}

Json json_of(const Moment& m) {
  return {{"time_s", m.time},
          {"x", m.pose.x},
          {"y", m.pose.y},
          {"yaw", m.pose.yaw},
          {"speed", m.speed},
          {"driven", {{"steer", m.driven.steer}, {"speed", m.driven.speed}}},
          {"planned", {{"steer", m.planned.steer}, {"speed", m.planned.speed}}},
          {"status", vehicle::name(m.status)}};
}

/// Prints how the commands differ, and returns it with all moments.
Json report(std::FILE* out, const std::vector<Moment>& moments) {
  Json json;
  std::vector<double> steering, speed;
  std::array<int, 7> statuses{};
  for (const Moment& moment : moments) {
    steering.push_back(moment.steering());
    speed.push_back(std::abs(moment.planned.speed - moment.driven.speed));
    ++statuses[static_cast<std::size_t>(moment.status)];
  }
  std::fprintf(out, "\ndifference          median      95 %%   largest\n");
  tell(out, json, "steering, rad", "steering_rad", steering);
  tell(out, json, "speed, m/s", "speed_m_s", speed);
  std::fprintf(out, "\nthe planner:");
  for (std::size_t i = 0; i < statuses.size(); ++i) {
    const char* const status = vehicle::name(static_cast<vehicle::PlannerStatus>(i));
    json["status"][status] = statuses[i];
    if (statuses[i] > 0) std::fprintf(out, " %s at %d moments", status, statuses[i]);
  }
  std::fprintf(out,
               "\n\nlargest differences in steering\n"
               "%8s %8s %8s %7s %15s %15s\n",
               "time, s", "x, m", "y, m", "m/s", "driven", "planned");
  for (const Moment& m : most_different(moments))
    std::fprintf(out, "%8.2f %8.2f %8.2f %7.2f %6.3f rad %4.1f %6.3f rad %4.1f  %s\n", m.time, m.pose.x,
                 m.pose.y, m.speed, m.driven.steer, m.driven.speed, m.planned.steer, m.planned.speed,
                 vehicle::name(m.status));
  for (const Moment& moment : moments) json["moments"].push_back(json_of(moment));
  return json;
}

/// Shows what the planner would have done at each moment of a recorded drive: it gets the recorded poses,
/// speeds and scans, and the car obeys the recorded commands. Prints how its commands differ, and the moments
/// where they differ most. Returns the exit status. Throws IoError, CommandLineError.
int replay_against(const AgainstArguments& arguments) {
  std::FILE* const words = arguments.json == "-" ? stderr : stdout;
  const DrivenRecording drive = read_drive(arguments.recording, Wanted::scans);
  const double interval = scan_interval(drive, arguments.recording);
  const Scenario scenario = load_scenario(arguments.scenario, arguments.method);
  evaluation::LapSetup setup{scenario.environment, {scenario.configuration, arguments.method}, scenario.lap};
  double& period = setup.driver.configuration.planner.control_period;
  const auto stride = static_cast<std::size_t>(std::max(1L, std::lround(period / interval)));
  period = static_cast<double>(stride) * interval;
  if (!drive.topics.empty()) std::fprintf(words, "%s\n", drive.topics.c_str());
  std::fprintf(words, "scans come every %.3f s; %s plans every %.3f s\n", interval, arguments.method.c_str(),
               period);
  Comparison comparison(drive, setup);
  const std::vector<Moment> moments = comparison.run(stride);
  if (moments.empty())
    throw IoError(arguments.recording, 0,
                  drive.in_map ? "has no scan at whose time pose, speed and command are known"
                               : "the car was never localised on the map; give its first pose with --start");
  if (comparison.unknown() > 0)
    std::fprintf(words, "pose, speed or command are not known at %zu of %zu scans\n", comparison.unknown(),
                 comparison.unknown() + moments.size());
  Json json = report(words, moments);
  if (!arguments.plot.empty()) {
    draw_plans(map_of(scenario), setup, comparison.driven(), comparison.plans(),
               formatted("%s beside a recorded drive of %.1f s", arguments.method.c_str(),
                         moments.back().time - moments.front().time),
               arguments.plot);
    std::fprintf(words, "picture: %s\n", arguments.plot.c_str());
  }
  if (!arguments.json.empty()) write_json(json, arguments.json);
  return 0;
}

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
