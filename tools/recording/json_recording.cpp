#include "tools/recording/json_recording.hpp"

#include <charconv>
#include <cmath>

#include "slalom/core/error.hpp"
#include "slalom/core/version.hpp"
#include "src/evaluation/json.hpp"
#include "tools/report/lap_json.hpp"

namespace slalom::tools {

JsonRecording::JsonRecording(const std::string& file, const Json& settings)
    : file_(file), stream_(file, std::ios::binary) {
  if (!stream_) throw IoError(file, 0, "cannot be written");
  line_ = Json{{"type", "recording"}, {"version", 1}, {"program", version()}, {"settings", settings}}.dump();
  write();
}

void JsonRecording::write() {
  line_ += '\n';
  stream_ << line_;
  line_.clear();
}

/// Shortest text that reads back to the same value; JSON has no infinity and no NaN.
template <class Number>
void JsonRecording::number(Number value) {
  if (!std::isfinite(value)) {
    line_ += "null";
    return;
  }
  char buffer[32];
  line_.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

template <class Values>
void JsonRecording::list(const char* key, const Values& values) {
  line_.append(",\"").append(key).append("\":[");
  bool first = true;
  for (const auto value : values) {
    if (!first) line_ += ',';
    first = false;
    number(value);
  }
  line_ += ']';
}

void JsonRecording::begin_lap(int lap, std::uint64_t seed) {
  line_ = Json{{"type", "lap"}, {"lap", lap}, {"seed", seed}}.dump();
  write();
}

void JsonRecording::add(const evaluation::ControlStep& tick) {
  const auto& seen = tick.seen;
  const auto& output = tick.output;
  const auto& odometry = tick.odometry;
  const double slip = seen.slip;
  line_ = "{\"type\":\"tick\",\"step\":" + std::to_string(tick.step) + ",\"time\":";
  number(tick.time);
  list("car", std::initializer_list<double>{seen.pose.x, seen.pose.y, seen.pose.yaw, seen.speed, seen.steer,
                                            seen.yaw_rate, slip});
  list("odometry",
       std::initializer_list<double>{odometry.pose.x, odometry.pose.y, odometry.pose.yaw, odometry.speed});
  list("scan", std::initializer_list<double>{tick.scan.angle_min, tick.scan.angle_increment,
                                             tick.scan.range_min, tick.scan.range_max});
  list("ranges", tick.scan.ranges);
  line_.append(",\"status\":\"").append(vehicle::name(output.status)).append("\"");
  list("command", std::initializer_list<double>{output.command.steer, output.command.speed});
  line_ += ",\"steer_estimate\":";
  number(output.steer_estimate);
  if (output.parameters.friction > 0) {
    const vehicle::ParameterEstimate& p = output.parameters;
    list("state_estimate", std::initializer_list<double>{output.speed_estimate, output.yaw_rate_estimate,
                                                         output.slip_estimate});
    list("parameter_estimate",
         std::initializer_list<double>{p.friction, p.friction_deviation, p.cautious_friction, p.steering_gain,
                                       p.steering_gain_deviation, p.delay, p.delay_deviation, p.confidence});
  }
  list("inputs", output.inputs);
  line_ += ",\"predicted\":[";
  for (std::size_t k = 0; k < output.predicted.size(); ++k) {
    const auto& state = output.predicted[k];
    line_ += k > 0 ? ",[" : "[";
    const double values[] = {state.pose.x, state.pose.y, state.pose.yaw, state.speed, state.steer};
    for (std::size_t i = 0; i < 5; ++i) {
      if (i > 0) line_ += ',';
      number(values[i]);
    }
    line_ += ']';
  }
  line_ += ']';
  list("cost", std::initializer_list<double>{tick.cost.state, tick.cost.collision});
  if (output.solve) {
    list("nominal", output.solve->nominal);
    list("covariance", output.solve->variances);
    line_ += ",\"effective_samples\":";
    number(output.solve->effective_sample_size);
    line_ += ",\"collided_share\":";
    number(output.solve->collided_share);
  }
  line_.append(",\"contacts\":").append(std::to_string(tick.collisions)).append("}");
  write();
}

void JsonRecording::end_lap(const evaluation::LapResult& lap, int number) {
  line_ = Json{{"type", "lap_end"}, {"result", lap_json(lap, number)}}.dump();
  write();
}

void JsonRecording::close() {
  stream_.close();
  if (!stream_) throw IoError(file_, 0, "cannot be written completely; the disk may be full");
}

}  // namespace slalom::tools
