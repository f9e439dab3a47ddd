#include "tools/recording/recording.hpp"

#include <charconv>
#include <cmath>
#include <fstream>

#include "slalom/core/error.hpp"
#include "slalom/core/files/write_file.hpp"
#include "slalom/core/version.hpp"
#include "src/evaluation/json.hpp"
#include "tools/live_view/view_setup.hpp"
#include "tools/scenario/lap_json.hpp"
#include "view/protocol/frame.hpp"
#include "view/protocol/messages.hpp"
#include "view/recording/recorder.hpp"

namespace slalom::tools {
namespace {

/// Closes the file of a recording. Throws IoError if anything could not be written.
void close_file(std::ofstream& stream, const std::string& file) {
  stream.close();
  if (!stream) throw cannot_write(file);
}

/// JSON lines: settings, then for each lap its start, the inputs and outputs of every control step, and its
/// end.
class JsonRecording : public Recording {
 public:
  /// Throws IoError.
  JsonRecording(const std::string& file, const Json& settings)
      : file_(file), stream_(file, std::ios::binary) {
    if (!stream_) throw cannot_write(file);
    write({{"type", "recording"}, {"version", 1}, {"program", version()}, {"settings", settings}});
  }

  void begin_lap(int number, std::uint64_t seed) override {
    write({{"type", "lap"}, {"lap", number}, {"seed", seed}});
  }
  void add(const evaluation::ControlStep& tick) override;
  void end_lap(const evaluation::LapResult& lap, int number) override {
    write({{"type", "lap_end"}, {"result", lap_json(lap, number)}});
  }
  void close() override { close_file(stream_, file_); }

 private:
  void write(const Json& record) { stream_ << record.dump() << '\n'; }

  /// Appends the shortest text that reads back to the same value; JSON has no infinity and no NaN.
  template <class Number>
  void value(Number number) {
    char buffer[32];
    if (std::isfinite(number))
      line_.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, number).ptr);
    else
      line_ += "null";
  }
  template <class Values>
  void values(const Values& numbers) {
    const char* between = "[";
    for (const auto number : numbers) {
      line_ += between;
      value(number);
      between = ",";
    }
    line_ += *between == '[' ? "[]" : "]";
  }
  void key(const char* name) { line_.append(",\"").append(name).append("\":"); }
  void number(const char* name, double number) {
    key(name);
    value(number);
  }
  template <class Values = std::initializer_list<double>>
  void list(const char* name, const Values& numbers) {
    key(name);
    values(numbers);
  }

  std::string file_;
  std::ofstream stream_;
  std::string line_;
};

void JsonRecording::add(const evaluation::ControlStep& tick) {
  const auto& seen = tick.seen;
  const auto& output = tick.output;
  const auto& odometry = tick.odometry;
  line_ = "{\"type\":\"tick\",\"step\":" + std::to_string(tick.step);
  number("time", tick.time);
  list("car",
       {seen.pose.x, seen.pose.y, seen.pose.yaw, seen.speed, seen.steer, seen.yaw_rate, double{seen.slip}});
  list("odometry", {odometry.pose.x, odometry.pose.y, odometry.pose.yaw, odometry.speed});
  list("scan", {tick.scan.angle_min, tick.scan.angle_increment, tick.scan.range_min, tick.scan.range_max});
  list("ranges", tick.scan.ranges);
  key("status");
  line_.append("\"").append(vehicle::name(output.status)).append("\"");
  list("command", {output.command.steer, output.command.speed});
  number("steer_estimate", output.steer_estimate);
  if (output.parameters.friction > 0) {
    const vehicle::ParameterEstimate& p = output.parameters;
    list("state_estimate", {output.speed_estimate, output.yaw_rate_estimate, output.slip_estimate});
    list("parameter_estimate", {p.friction, p.friction_deviation, p.cautious_friction, p.steering_gain,
                                p.steering_gain_deviation, p.delay, p.delay_deviation, p.confidence});
  }
  list("inputs", output.inputs);
  key("predicted");
  const char* between = "[";
  for (const auto& state : output.predicted) {
    line_ += between;
    values(
        std::initializer_list<double>{state.pose.x, state.pose.y, state.pose.yaw, state.speed, state.steer});
    between = ",";
  }
  line_ += *between == '[' ? "[]" : "]";
  list("cost", {tick.cost.state, tick.cost.collision});
  if (output.solve) {
    list("nominal", output.solve->nominal);
    list("covariance", output.solve->variances);
    number("effective_samples", output.solve->effective_sample_size);
    number("collided_share", output.solve->collided_share);
  }
  line_.append(",\"contacts\":").append(std::to_string(tick.collisions)).append("}\n");
  stream_ << line_;
}

view::RecorderOptions recorder_options(const RecordingFacts& facts) {
  const sim::WorldOptions world = facts.scenario.environment->world_options();
  return {.program = std::string("slalom ") + version(),
          .settings = {{"settings", json_text(facts.settings)}},
          .lidar_angle_min = world.lidar.angle_min(),
          .lidar_angle_increment = world.lidar.angle_increment(),
          .everything = facts.everything,
          .wall_clock = facts.times};
}

/// MCAP, as the live view records.
class McapRecording : public Recording {
 public:
  /// Throws IoError.
  McapRecording(const std::string& file, const RecordingFacts& facts)
      : file_(file),
        further_arguments_(further_arguments(facts.arguments)),
        environment_(facts.scenario.environment),
        configuration_(facts.scenario.configuration),
        choices_(choices()),
        state_{.names = {.course = environment_->course.name,
                         .method = facts.method,
                         .config = facts.arguments.config,
                         .seed = facts.seed,
                         .obstacles = facts.scenario.lap.obstacles,
                         .opponents = facts.scenario.lap.opponents}},
        control_period_(facts.control_period),
        stream_(file, std::ios::binary),
        recorder_(stream_, recorder_options(facts)) {
    if (!stream_) throw cannot_write(file);
    recorder_.add_text(view::hello_message(*environment_, choices_, 0, control_period_));
    recorder_.add_course(view::encode_scene(*environment_));
    recorder_.add_text(view::options_message({.names = state_.names,
                                              .now = configuration_,
                                              .loaded = configuration_,
                                              .further_arguments = further_arguments_}));
  }

  void begin_lap(int, std::uint64_t seed) override {
    state_.names.seed = seed;
    recorder_.begin_drive();
    tell_state();
  }

  void add(const evaluation::ControlStep& tick) override {
    ++ticks_;
    recorder_.add_frame(encoder_.encode(tick, {.deadline = control_period_,
                                               .prediction_step = configuration_.vehicle.time_step,
                                               .method = choices_.method_index(state_.names.method)}) +
                        view::encode_bodies(tick.world));
  }

  void end_lap(const evaluation::LapResult& lap, int number) override {
    if (!lap.finished) return;
    state_.laps.push_back({.tick = ticks_,
                           .lap = number,
                           .time = lap.time,
                           .contacts = lap.collisions,
                           .method = state_.names.method});
    tell_state();
  }

  void close() override {
    recorder_.finish();
    close_file(stream_, file_);
  }

 private:
  void tell_state() { recorder_.add_text(view::state_message(state_, *environment_, control_period_)); }

  std::string file_, further_arguments_;
  std::shared_ptr<const evaluation::Environment> environment_;
  vehicle::Configuration configuration_;
  view::Choices choices_;
  view::DriveState state_;
  double control_period_;
  int ticks_ = 0;
  std::ofstream stream_;
  view::FrameEncoder encoder_;
  view::Recorder recorder_;
};

}  // namespace

std::unique_ptr<Recording> make_recording(const std::string& file, const RecordingFacts& facts) {
  if (file.size() >= 5 && file.compare(file.size() - 5, 5, ".mcap") == 0)
    return std::make_unique<McapRecording>(file, facts);
  if (facts.times || facts.everything)
    throw CommandLineError(facts.times ? "--record-times" : "--record-all",
                           "needs a recording in MCAP, whose name ends in .mcap");
  return std::make_unique<JsonRecording>(file, facts.settings);
}

}  // namespace slalom::tools
