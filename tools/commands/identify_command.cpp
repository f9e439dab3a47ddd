#include <memory>

#include "slalom/core/error.hpp"
#include "slalom/evaluation/json.hpp"
#include "slalom/vehicle/model/identification.hpp"
#include "tools/commands/commands.hpp"
#include "tools/recorded_drives/driven_samples.hpp"
#include "tools/terminal/json_output.hpp"

namespace slalom::tools {
namespace {

using vehicle::Identification;
using vehicle::Identified;

struct IdentifyArguments {
  std::string recording, json;
  vehicle::IdentificationOptions options;
};

void print(std::FILE* out, const char* name, const Identified& value, const char* unit) {
  std::fprintf(out, "%-20s %9.4f %-6s", name, value.value, unit);
  if (value.deviation > 0)
    std::fprintf(out, " +- %.4f", value.deviation);
  else
    std::fprintf(out, " (given)");
  std::fprintf(out, "\n");
}

/// Prints the lines for a configuration file.
void advise(std::FILE* out, const Identification& found) {
  const double ratio = found.steering_gain.value / found.wheelbase.value;
  const bool wheelbase_known = found.wheelbase.deviation < 0.1 * found.wheelbase.value;
  if (!wheelbase_known)
    std::fprintf(out,
                 "This drive determines only the ratio of gain and wheelbase, %.3f 1/m. Measure the "
                 "wheelbase and give "
                 "it with --wheelbase.\n\n",
                 ratio);
  std::fprintf(out,
               "For a configuration file (correct gain and offset in the servo driver):\n"
               "vehicle:\n  steer_time_constant: %.3f\n  dead_time: %.3f\n",
               found.time_constant.value, found.delay.value);
  if (wheelbase_known)
    std::fprintf(out, "  front_length: %.4f\n  rear_length: %.4f\n", 0.4808 * found.wheelbase.value,
                 0.5192 * found.wheelbase.value);
  std::fprintf(out, "planner:\n  observer_time_constant: %.3f\n", found.time_constant.value);
}

int identify(const IdentifyArguments& arguments) {
  const auto samples = read_driven_samples(arguments.recording);
  const Identification found = [&] {
    try {
      return vehicle::identify(samples, arguments.options);
    } catch (const std::invalid_argument& error) {
      throw IoError(arguments.recording, 0, error.what());
    }
  }();
  std::FILE* words = arguments.json == "-" ? stderr : stdout;
  std::fprintf(words, "%d of %zu samples; %.1f %% of the yaw rate explained, residual %.3f rad/s\n\n",
               found.samples, samples.size(), 100 * found.explained, found.residual);
  print(words, "steering gain", found.steering_gain, "");
  print(words, "steering offset", found.steering_offset, "rad");
  print(words, "delay", found.delay, "s");
  print(words, "time constant", found.time_constant, "s");
  print(words, "wheelbase", found.wheelbase, "m");
  print(words, "understeer", found.understeer, "s^2/m");
  std::fprintf(words, "%-20s %9.4f        (distance from the poses / distance from the speed)\n\n",
               "speed scale", found.speed_scale);
  advise(words, found);
  if (arguments.json.empty()) return 0;
  const auto pair = [](const Identified& value) {
    return Json{{"value", value.value}, {"deviation", value.deviation}};
  };
  write_json({{"samples", found.samples},
              {"explained", found.explained},
              {"residual", found.residual},
              {"steering_gain", pair(found.steering_gain)},
              {"steering_offset", pair(found.steering_offset)},
              {"delay", pair(found.delay)},
              {"time_constant", pair(found.time_constant)},
              {"wheelbase", pair(found.wheelbase)},
              {"understeer", pair(found.understeer)},
              {"speed_scale", found.speed_scale}},
             arguments.json);
  return 0;
}

}  // namespace

void declare_identify(Subcommand& command) {
  command.summary("Estimate steering gain, offset, delay, lag and wheelbase of a car from a recording");
  const auto arguments = std::make_shared<IdentifyArguments>();
  command
      .option("recording", arguments->recording,
              "Recording of slalom drive --record in JSON lines, or a ROS 1 bag")
      .required();
  command.option("--wheelbase", arguments->options.wheelbase, "Measured wheelbase, m [estimated]")
      .range(0.01, 20.0);
  command.option("--least-speed", arguments->options.min_speed, "Samples below this speed are ignored, m/s")
      .range(0.01, 100.0)
      .show_default();
  command.option("--json", arguments->json,
                 "Write the estimates as JSON to this file, or to standard output: -");
  command.action([arguments] { return identify(*arguments); });
}

}  // namespace slalom::tools
