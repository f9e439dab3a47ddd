
#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "slalom/vehicle/model/identification.hpp"
#include "slalom/vehicle/model/tyre_identification.hpp"
#include "tools/commands/commands.hpp"
#include "tools/recording/driven_recording.hpp"
#include "tools/scenario/scenario.hpp"
#include "tools/terminal/json_output.hpp"

namespace slalom::tools {
namespace {

using vehicle::Identification;
using vehicle::Identified;
using vehicle::TyreIdentification;

struct IdentifyArguments {
  std::string recording, json;
  std::string config = "default";
  bool tyres = false;
  vehicle::IdentificationOptions options;
};

/// An estimate with its names in words and in JSON.
struct Estimate {
  const char *words, *key;
  const Identified& value;
  const char* unit;
};

/// Prints estimates and adds them to the JSON.
void tell(std::FILE* out, Json& json, std::initializer_list<Estimate> estimates) {
  for (const auto& [words, key, estimate, unit] : estimates) {
    std::fprintf(out, "%-20s %9.4f %-6s", words, estimate.value, unit);
    if (estimate.deviation > 0)
      std::fprintf(out, " +- %.4f\n", estimate.deviation);
    else
      std::fprintf(out, " (given)\n");
    json[key] = {{"value", estimate.value}, {"deviation", estimate.deviation}};
  }
}

/// Prints the estimates of the steering and adds them to the JSON.
void tell_steering(std::FILE* out, Json& json, const auto& found) {
  tell(out, json,
       {{"steering gain", "steering_gain", found.steering_gain, ""},
        {"steering offset", "steering_offset", found.steering_offset, "rad"},
        {"delay", "delay", found.delay, "s"},
        {"time constant", "time_constant", found.time_constant, "s"}});
}

/// Prints the lines on the steering for a configuration file.
void advise_steering(std::FILE* out, const auto& found) {
  std::fprintf(out,
               "For a configuration file (correct gain and offset in the servo driver):\n"
               "vehicle:\n  steer_time_constant: %.3f\n  dead_time: %.3f\n",
               found.time_constant.value, found.delay.value);
}

/// Prints the lines for a configuration file.
void advise(std::FILE* out, const Identification& found) {
  const double ratio = found.steering_gain.value / found.wheelbase.value;
  const bool wheelbase_known = found.wheelbase.deviation < 0.1 * found.wheelbase.value;
  if (!wheelbase_known)
    std::fprintf(out,
                 "This drive determines only the ratio of gain and wheelbase, %.3f 1/m. Measure the "
                 "wheelbase and give it with --wheelbase.\n\n",
                 ratio);
  advise_steering(out, found);
  if (wheelbase_known)
    std::fprintf(out, "  front_length: %.4f\n  rear_length: %.4f\n", 0.4808 * found.wheelbase.value,
                 0.5192 * found.wheelbase.value);
  std::fprintf(out, "planner:\n  observer_time_constant: %.3f\n", found.time_constant.value);
}

/// Estimates steering, delay and wheelbase of a car whose tyres hardly slip.
Json identify_steering(std::FILE* out, std::span<const vehicle::DrivenSample> samples,
                       const vehicle::IdentificationOptions& options) {
  const Identification found = vehicle::identify(samples, options);
  std::fprintf(out, "%d of %zu samples; %.1f %% of the yaw rate explained, residual %.3f rad/s\n\n",
               found.samples, samples.size(), 100 * found.explained, found.residual);
  Json json{{"samples", found.samples}, {"explained", found.explained}, {"residual", found.residual}};
  tell_steering(out, json, found);
  tell(out, json,
       {{"wheelbase", "wheelbase", found.wheelbase, "m"},
        {"understeer", "understeer", found.understeer, "s^2/m"}});
  std::fprintf(out, "%-20s %9.4f        (distance from the poses / distance from the speed)\n\n",
               "speed scale", found.speed_scale);
  advise(out, found);
  json["speed_scale"] = found.speed_scale;
  return json;
}

/// Estimates tyres, friction and steering of a car whose tyres slip; its geometry and mass are those of a
/// configuration.
Json identify_tyres(std::FILE* out, std::span<const vehicle::DrivenSample> samples,
                    const IdentifyArguments& arguments) {
  ScenarioArguments scenario{.config = arguments.config};
  const vehicle::Configuration car = load_configuration(scenario, "svg_mppi");
  const TyreIdentification found = vehicle::identify_tyres(
      samples, car.vehicle, car.vehicle.own_of<vehicle::SingleTrackOptions>(), arguments.options);
  std::fprintf(
      out,
      "%d windows of 0.2 s; residuals %.4f rad and %.4f m sideways; up to %.0f %% of the grip used to "
      "turn\n\n",
      found.windows, found.yaw_residual, found.sideways_residual, 100 * found.grip_used);
  Json json{{"windows", found.windows},
            {"yaw_residual", found.yaw_residual},
            {"sideways_residual", found.sideways_residual},
            {"grip_used", found.grip_used}};
  tell(out, json,
       {{"friction", "friction", found.friction, ""},
        {"cornering, front", "cornering_front", found.cornering_front, "1/rad"},
        {"cornering, rear", "cornering_rear", found.cornering_rear, "1/rad"}});
  tell_steering(out, json, found);
  std::fputs("\n", out);
  const double front = found.cornering_front.value, rear = found.cornering_rear.value;
  if (found.friction.deviation > 0.05 * found.friction.value) {
    std::fprintf(out,
                 "This drive determines only friction times cornering stiffness: %.2f 1/rad in front, %.2f "
                 "1/rad behind. Drive curves closer to the limit of grip.\n",
                 found.friction.value * front, found.friction.value * rear);
    return json;
  }
  advise_steering(out, found);
  std::fprintf(out, "  friction: %.3f\n  cornering_front: %.2f\n  cornering_rear: %.2f\n",
               found.friction.value, front, rear);
  return json;
}

int identify(const IdentifyArguments& arguments) {
  std::FILE* const words = arguments.json == "-" ? stderr : stdout;
  const DrivenRecording drive = read_drive(arguments.recording);
  const auto& samples = drive.samples;
  if (!drive.topics.empty()) std::fprintf(words, "%s\n", drive.topics.c_str());
  const Json found = [&] {
    try {
      return arguments.tyres ? identify_tyres(words, samples, arguments)
                             : identify_steering(words, samples, arguments.options);
    } catch (const std::invalid_argument& error) {
      throw IoError(arguments.recording, 0, error.what());
    }
  }();
  if (!arguments.json.empty()) write_json(found, arguments.json);
  return 0;
}

}  // namespace

void declare_identify(Subcommand& command) {
  command.summary(
      "Estimate steering, delay and wheelbase of a car, or its tyres and friction, from a recording");
  const auto arguments = std::make_shared<IdentifyArguments>();
  command.option("recording", arguments->recording,
                 "Recording of slalom drive --record, or a bag of rosbag2 (file or folder)",
                 {.required = true});
  command.flag("--tyres", arguments->tyres,
               "Find friction and cornering stiffness, of a drive close to the limit of grip");
  command.option("--wheelbase", arguments->options.wheelbase, "Measured wheelbase, m [estimated]",
                 {.least = 0.01, .most = 20.0, .excludes = {"--tyres"}});
  command.option("--config", arguments->config,
                 "With --tyres: configuration with the lengths, mass and inertia of the car",
                 {.needs = "--tyres"});
  command.json(arguments->json, "the estimates");
  command.examples({"identify lap.mcap --wheelbase 0.33", "identify first --tyres --config my_car.yaml"});
  command.action([arguments] { return identify(*arguments); });
}

}  // namespace slalom::tools
