#include "tools/recording/driven_recording.hpp"

#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "slalom/core/files/write_file.hpp"
#include "slalom/core/read_file.hpp"
#include "slalom/core/version.hpp"
#include "slalom/maps/pose_limits.hpp"
#include "slalom/sim/lidar.hpp"
#include "tools/command_line/words.hpp"
#include "tools/live_view/view_setup.hpp"
#include "view/recording/mcap_reader.hpp"

namespace slalom::tools {
namespace {

view::RecorderOptions recorder_options(const RecordingFacts& facts) {
  const sim::WorldOptions world = facts.scenario.environment->world_options();
  return {.program = std::string("slalom ") + version(),
          .settings = {{"settings", json_text(facts.settings)}},
          .lidar_angle_min = world.lidar.angle_min(),
          .lidar_angle_increment = world.lidar.angle_increment(),
          .everything = facts.everything,
          .wall_clock = facts.times};
}

namespace fs = std::filesystem;

constexpr std::uintmax_t max_bytes = std::uintmax_t{1} << 32;  // size of a recording
constexpr double spacing = 0.1;                                // m between the points that are kept
constexpr double meeting = 1.0;                                // m, within which a lap ends where it began
constexpr double min_lap = 10;                                 // m

/// The first bytes of a recording, which tell its format. Throws IoError if it is too large or not a file.
std::string first_bytes(const std::string& file) {
  if (!fs::is_regular_file(file)) throw IoError(file, 0, "cannot be read: it must be a regular file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw cannot_open(file);
  if (const auto size = fs::file_size(file); size > max_bytes)
    throw IoError(
        file, 0,
        "has " + std::to_string(size) + " bytes; at most " + std::to_string(max_bytes) + " are read");
  std::string bytes(16, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return bytes;
}

/// The files of a bag: those of a folder that rosbag2 wrote, in the order of their names, or the file itself.
std::vector<std::string> files_of(const std::string& recording) {
  if (!fs::is_directory(recording)) return {recording};
  std::vector<std::string> files;
  for (const fs::path& file : list_folder(recording))
    if (file.extension() == ".mcap" || file.extension() == ".db3") files.push_back(file.string());
  if (files.empty()) throw IoError(recording, 0, "is a folder without files of rosbag2 (.mcap, .db3)");
  return files;
}

/// The control step of a message of the topic /tick.
vehicle::DrivenSample tick_sample(double time, std::string_view message) {
  const Json tick = parse_json(message);
  const auto number = [&](const char* key) {
    const Json& value = member(tick, key);
    return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
  };
  return {time,
          number("odometry_x"),
          number("odometry_y"),
          number("odometry_yaw"),
          number("odometry_speed"),
          number("command_steer"),
          number("command_speed")};
}

/// The scan of a message of the topic /scan.
RecordedScan scan_of(double time, std::string_view message) {
  const Json json = parse_json(message);
  RecordedScan scan{.time = time, .shape = {}, .ranges = {}};
  for (const Json& range : member(json, "ranges")) {
    if (!range.is_number()) throw std::invalid_argument("key 'ranges': must have numbers");
    scan.ranges.push_back(range.get<float>());
  }
  scan.shape.angle_min = member<double>(json, "start_angle");
  const double angles = member<double>(json, "end_angle") - scan.shape.angle_min;
  scan.shape.angle_increment = angles / static_cast<double>(std::max<std::size_t>(scan.ranges.size(), 2) - 1);
  scan.shape.range_max = sim::LidarOptions{}.range_max;
  return scan;
}

/// Reads an MCAP file: adds the ticks of a recording to `drive`, and the messages of a bag to `bag`.
void read_mcap(const std::string& file, Wanted wanted, DrivenRecording& drive, RosDrive& bag) {
  std::string refused;
  const auto add = [&](const view::mcap::MessageView& message) {
    const double time = 1e-9 * static_cast<double>(message.time);
    try {
      if (message.encoding == "cdr")
        bag.add(message.topic, message.schema, message.time, message.data);
      else if (message.schema == "slalom.Tick")
        drive.samples.push_back(tick_sample(time, message.data));
      else if (message.topic == "/scan" && wanted == Wanted::scans)
        drive.scans.push_back(scan_of(time, message.data));
    } catch (const std::invalid_argument& error) {
      refused = std::string(message.topic) + ": " + error.what();
    }
  };
  view::mcap::read_records(file, true, {.message = add, .attachment = {}});
  if (!refused.empty()) throw IoError(file, 0, "has a message that cannot be read: " + refused);
}

}  // namespace

Recording::Recording(const std::string& file, const RecordingFacts& facts)
    : file_(file),
      facts_(view::car_facts(facts.scenario.environment.get())),
      prediction_step_(facts.scenario.configuration.vehicle.time_step),
      choices_(choices()),
      control_period_(facts.control_period),
      stream_(file, std::ios::binary),
      recorder_(stream_, recorder_options(facts)) {
  if (!stream_) throw cannot_write(file);
  const evaluation::Environment& environment = *facts.scenario.environment;
  state_.names = view::with_course({.course = environment.course.name,
                                    .method = facts.method,
                                    .config = facts.arguments.config,
                                    .seed = facts.seed,
                                    .obstacles = facts.scenario.lap.obstacles,
                                    .opponents = facts.scenario.lap.opponents},
                                   environment);
  state_.control_period = control_period_;
  state_.bounds = view::bounds_of(facts_->course);
  recorder_.add_text(view::hello_message(*facts_, choices_, 0, control_period_));
  recorder_.add_course(view::encode_scene(*facts_));
  recorder_.add_text(
      view::options_message({.names = state_.names,
                             .sections = view::sections_of(facts.scenario.configuration, facts.method),
                             .fixes_seed = true,
                             .further_arguments = further_arguments(facts.arguments)}));
}

void Recording::begin_lap(std::uint64_t seed) {
  state_.names.seed = seed;
  recorder_.begin_drive();
  tell_state();
}

void Recording::add(const evaluation::ControlStep& tick) {
  ++ticks_;
  recorder_.add_frame(view::encode_car(facts_, tick, control_period_, prediction_step_,
                                       choices_.method_index(state_.names.method)));
}

void Recording::end_lap(const evaluation::LapResult& lap, int number) {
  if (!lap.finished) return;
  state_.laps.push_back({.end = ticks_,
                         .lap = number,
                         .time = lap.time,
                         .contacts = lap.collisions,
                         .method = state_.names.method});
  tell_state();
}

void Recording::close() {
  recorder_.finish();
  stream_.close();
  if (!stream_) throw cannot_write(file_);
}

void Recording::tell_state() {
  recorder_.add_text(view::state_message(state_));
}

DrivenRecording read_drive(const std::string& recording, Wanted wanted) {
  RosDrive bag(wanted);
  DrivenRecording drive;
  for (const std::string& file : files_of(recording)) {
    const std::string magic = first_bytes(file);
    if (magic.starts_with("SQLite format 3"))
      read_sqlite_bag(file, bag);
    else if (magic.starts_with("\x89MCAP"))
      read_mcap(file, wanted, drive, bag);
    else
      throw IoError(file, 0, "is neither a recording in MCAP nor a bag of rosbag2");
  }
  if (!drive.samples.empty()) return drive;
  try {
    return bag.drive();
  } catch (const std::invalid_argument& error) {
    throw IoError(recording, 0, error.what());
  }
}

vehicle::GuideLine driven_line(const std::string& file) {
  vehicle::GuideLine line{.closed = false};
  std::vector<double> times;  // s, of the points
  double driven = 0, nearest = meeting;
  std::size_t lap = 0;  // points of the first lap, if one was driven
  for (const vehicle::DrivenSample& sample : read_drive(file).samples) {
    if (std::isnan(sample.x) || std::isnan(sample.y)) continue;
    if (!maps::is_plausible(maps::Point{sample.x, sample.y}))
      throw IoError(file, 0, formatted("at %.2f s: the pose: ", sample.time) + maps::PoseLimits::rule);
    if (!line.points.empty()) {
      const double way = std::hypot(sample.x - line.points.back().x, sample.y - line.points.back().y);
      if (way < spacing) continue;
      driven += way;
    }
    line.points.push_back({sample.x, sample.y});
    times.push_back(sample.time);
    const maps::Point& first = line.points.front();
    const double apart = std::hypot(sample.x - first.x, sample.y - first.y);
    if (driven < min_lap) continue;
    if (apart < nearest) {
      nearest = apart;
      lap = line.points.size();
    } else if (lap > 0) {
      break;  // the place where the lap ended is behind
    }
  }
  if (lap > 0) {
    line.closed = true;
    line.points.resize(lap - (nearest < spacing ? 1 : 0));
  }
  if (const std::size_t jump = vehicle::find_jump(line.points); jump > 0)
    throw IoError(
        file, 0, "at " + formatted("%.2f s, the pose ", times[jump]) + vehicle::jump_text(line.points, jump));
  if (line.points.size() < 4) throw IoError(file, 0, "must be the recording of a drive of at least 0.4 m");
  return line;
}

}  // namespace slalom::tools
